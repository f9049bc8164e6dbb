use super::Gpu;
use encase::internal::WriteInto;
use encase::{ShaderSize, ShaderType, StorageBuffer, UniformBuffer};

/// A uniform buffer that holds `value` in WGSL's layout.
pub fn uniform_buffer<T: ShaderType + WriteInto>(gpu: &Gpu, label: &str, value: &T) -> wgpu::Buffer {
    let mut bytes = UniformBuffer::new(Vec::<u8>::new());
    // Writing into a vector that grows cannot fail.
    let _ = bytes.write(value);
    init(gpu, label, &bytes.into_inner())
}

/// A uniform buffer that holds an array of `capacity` structs, the first of which are `values` and the rest zero.
///
/// For structs that are aligned to 16 bytes, as all with a vector or matrix in them are, the layout of such an array is that of a
/// storage buffer.
pub fn uniform_array<T: ShaderType + ShaderSize + WriteInto>(
    gpu: &Gpu,
    label: &str,
    values: &[T],
    capacity: usize,
) -> wgpu::Buffer {
    let mut bytes = StorageBuffer::new(Vec::<u8>::new());
    let _ = bytes.write(&values);
    let mut bytes = bytes.into_inner();
    bytes.resize(T::SHADER_SIZE.get() as usize * capacity, 0);
    init(gpu, label, &bytes)
}

/// A uniform buffer of structs that are bound one at a time, and the distance in bytes from one to the next.
pub fn uniform_each<T: ShaderType + ShaderSize + WriteInto>(
    gpu: &Gpu,
    label: &str,
    values: &[T],
) -> (wgpu::Buffer, u32) {
    let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
    let stride = (T::SHADER_SIZE.get() as u32).next_multiple_of(alignment);
    let mut bytes = Vec::new();
    for value in values {
        let mut one = UniformBuffer::new(Vec::<u8>::new());
        let _ = one.write(value);
        bytes.extend(one.into_inner());
        bytes.resize(bytes.len().next_multiple_of(stride as usize), 0);
    }
    (init(gpu, label, &bytes), stride)
}

/// A storage buffer of zeros that kernels write, and draws may take vertices from.
pub fn storage(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE
        | wgpu::BufferUsages::VERTEX
        | wgpu::BufferUsages::INDIRECT
        | wgpu::BufferUsages::COPY_SRC
        | wgpu::BufferUsages::COPY_DST;
    let label = Some(label);
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label,
        size: size.max(16),
        usage,
        mapped_at_creation: false,
    })
}

/// A storage buffer of structs in WGSL's layout, for kernels to read.
pub fn storage_array<T: ShaderType + ShaderSize + WriteInto>(
    gpu: &Gpu,
    label: &str,
    values: &[T],
) -> wgpu::Buffer {
    let mut bytes = StorageBuffer::new(Vec::<u8>::new());
    let _ = bytes.write(&values);
    storage_of(gpu, label, &bytes.into_inner())
}

/// A storage buffer of these bytes, for kernels to read.
pub fn storage_of(gpu: &Gpu, label: &str, contents: &[u8]) -> wgpu::Buffer {
    buffer_of(gpu, label, contents, wgpu::BufferUsages::STORAGE)
}

/// A buffer of these bytes. Where the driver has no room for it, [`Gpu::attempt`] says so: the buffer is then one that nothing can be done with.
pub fn buffer_of(gpu: &Gpu, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = (contents.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(wgpu::COPY_BUFFER_ALIGNMENT),
        usage,
        mapped_at_creation: true,
    });
    // `DeviceExt::create_buffer_init` does the same, but panics where there is nothing to write to.
    if let Ok(mut mapped) = buffer.get_mapped_range_mut(..) {
        mapped.slice(..contents.len()).copy_from_slice(contents);
        drop(mapped);
        buffer.unmap();
    }
    buffer
}

fn init(gpu: &Gpu, label: &str, contents: &[u8]) -> wgpu::Buffer {
    buffer_of(gpu, label, contents, wgpu::BufferUsages::UNIFORM)
}
