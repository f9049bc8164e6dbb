use super::Gpu;
use encase::internal::WriteInto;
use encase::{ShaderType, StorageBuffer, UniformBuffer};
use wgpu::util::DeviceExt;

/// A uniform buffer that holds `value` in WGSL's layout.
pub fn uniform_buffer<T: ShaderType + WriteInto>(gpu: &Gpu, label: &str, value: &T) -> wgpu::Buffer {
    let mut bytes = UniformBuffer::new(Vec::<u8>::new());
    // Writing into a vector that grows cannot fail.
    let _ = bytes.write(value);
    init(gpu, label, &bytes.into_inner(), wgpu::BufferUsages::UNIFORM)
}

/// A storage buffer that holds `values` in WGSL's layout. Never empty, since an empty buffer cannot be bound.
pub fn storage_buffer<T: ShaderType + encase::ShaderSize + WriteInto>(
    gpu: &Gpu,
    label: &str,
    values: &[T],
) -> wgpu::Buffer {
    let mut bytes = StorageBuffer::new(Vec::<u8>::new());
    let _ = bytes.write(&values);
    let mut bytes = bytes.into_inner();
    bytes.resize(bytes.len().max(T::SHADER_SIZE.get() as usize), 0);
    init(gpu, label, &bytes, wgpu::BufferUsages::STORAGE)
}

fn init(gpu: &Gpu, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}
