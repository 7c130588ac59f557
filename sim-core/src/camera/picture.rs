/// An image whose pixels are colours, depths or labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture<T> {
    size: [u32; 2],
    pixels: Vec<T>,
}

impl<T> Picture<T> {
    /// The picture of `size` (width and height) with these pixels, row by row from the top, each from the left.
    ///
    /// # Panics
    /// If the number of pixels differs from the product of width and height.
    pub fn new(size: [u32; 2], pixels: Vec<T>) -> Self {
        assert_eq!(size[0] as usize * size[1] as usize, pixels.len(), "the number of pixels is width times height");
        Self { size, pixels }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels, row by row from the top, each from the left.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// The pixels, mutable.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// The rows from the top.
    pub fn rows(&self) -> impl Iterator<Item = &[T]> {
        self.pixels.chunks_exact(self.size[0].max(1) as usize)
    }

    /// The rows from the top, mutable.
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        self.pixels.chunks_exact_mut(self.size[0].max(1) as usize)
    }

    /// The pixel in `column` from the left and `row` from the top.
    ///
    /// # Panics
    /// If the pixel lies outside the picture.
    pub fn pixel(&self, column: u32, row: u32) -> &T {
        assert!(column < self.size[0] && row < self.size[1], "a pixel of the picture");
        &self.pixels[row as usize * self.size[0] as usize + column as usize]
    }
}
