//! Sorting of short lists.

/// Sorts a list of few elements, or one that is almost sorted, by `key`, and keeps the order of elements with equal
/// keys (insertion sort). The sort of the standard library is several kilobytes of code for each type of element, which
/// a short list does not need.
pub(crate) fn sort_few<T, K: Ord>(list: &mut [T], key: impl Fn(&T) -> K) {
    for end in 1..list.len() {
        let mut index = end;
        while index > 0 && key(&list[index]) < key(&list[index - 1]) {
            list.swap(index, index - 1);
            index -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_that_of_the_standard_library() {
        for seed in 0_usize..200 {
            let mut list: Vec<(usize, usize)> = (0..seed % 12).map(|index| ((index + seed) * 7 % 5, index)).collect();
            let mut expected = list.clone();
            expected.sort_by_key(|element| element.0);
            sort_few(&mut list, |element| element.0);
            assert_eq!(list, expected);
        }
    }
}
