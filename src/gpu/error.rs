/// Why the GPU cannot do what was asked of it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter to draw with.
    #[error(
        "no graphics adapter was found ({0}). Tyndall draws with Vulkan, Metal or DirectX 12; on a machine without a graphics card a software \
         adapter serves: `apt-get install mesa-vulkan-drivers` on Debian and Ubuntu, `dnf install mesa-vulkan-drivers` on Fedora, or \
         `cargo xtask setup` in a checkout of Tyndall"
    )]
    NoAdapter(String),
    /// The app has no [`Gpu`](super::Gpu) resource.
    #[error("there is no GPU to draw with: insert the resource `tyndall::gpu::Gpu` first")]
    Missing,
    /// The adapter exists but gives no device.
    #[error("the graphics adapter `{adapter}` gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// A shader does not compile.
    #[error("the shader {0} does not compile:\n{1}")]
    Shader(String, String),
    /// A file that stands in for a shader cannot be read.
    #[error("cannot read the shader {}: {reason}; mend it, or take it away to use the shader built in", path.display())]
    ShaderFile {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A shader imports what does not exist.
    #[error("{file}:{line}: there is no shader `{import}` to import")]
    Import {
        /// The importing file.
        file: String,
        /// Line of the import.
        line: usize,
        /// The name imported.
        import: String,
    },
    /// The picture is larger than the adapter can make.
    #[error(
        "a picture of {width}x{height} is larger than this adapter's limit of {limit}x{limit}; ask for a smaller `--size`"
    )]
    PictureTooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// The most pixels along either side.
        limit: u32,
    },
    /// A grid has more texels along a side than the adapter can make.
    #[error(
        "{what}: {} x {} x {} texels are more than this adapter takes: {limit} along each side; lower the `resolution`",
        .size[0], .size[1], .size[2]
    )]
    GridTooLarge {
        /// What the grid is for.
        what: String,
        /// Texels along each axis.
        size: [u32; 3],
        /// The most texels along a side.
        limit: u32,
    },
    /// The driver refused, ran out of memory or lost the device.
    #[error("the graphics driver failed while {doing}: {reason}")]
    Driver {
        /// What was being done.
        doing: String,
        /// What the driver says.
        reason: String,
    },
}
