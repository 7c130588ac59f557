//! Suggestions for misspelt names.

/// The keyword nearest to `word` in edit distance; `None` if no keyword is near enough to be a plausible correction.
pub fn nearest<'k>(word: &str, keywords: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let word = word.to_lowercase();
    // A longer word gets no suggestion: keywords are shorter, and the time to compute a distance grows with the length
    // of the word.
    if word.chars().count() > 40 {
        return None;
    }
    keywords
        .into_iter()
        .map(|keyword| (strsim::osa_distance(&word, &keyword.to_lowercase()), keyword))
        .filter(|(distance, keyword)| {
            let length = keyword.len().min(word.len());
            *distance <= 1 + length / 5 && *distance < length
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, keyword)| keyword)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_keywords_are_found() {
        let keywords = ["push", "pop", "position", "floor", "floor_texture", "width"];
        for (word, keyword) in [
            ("ush", Some("push")),
            ("Push", Some("push")),
            ("psuh", Some("push")),
            ("postion", Some("position")),
            ("floor_textrue", Some("floor_texture")),
            ("banana", None),
            ("foo", None),
            ("x", None),
        ] {
            assert_eq!(nearest(word, keywords), keyword, "{word}");
        }
    }
}
