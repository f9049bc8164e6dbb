//! What the values of a label map mean.

/// The labels of a volume whose values name what is there and cannot be mixed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Labels {
    /// Those that the file describes; values beside them may occur.
    pub entries: Vec<Label>,
}

/// One label.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The value of its voxels.
    pub value: f32,
    /// What it is called; empty where the file does not say.
    pub name: String,
    /// Red, green, blue, as encoded in sRGB, and opacity, each 0 to 1; where the file says so.
    pub colour: Option<[f32; 4]>,
}
