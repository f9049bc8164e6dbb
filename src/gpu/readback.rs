use super::{Gpu, GpuError};

/// The texels of a 2D texture, row by row from the top, without padding.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
    let row = texture.width() * texture.format().block_copy_size(None).unwrap_or(4);
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(padded) * u64::from(texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_mapped(gpu, &buffer)?;
    let lines: Vec<&[u8]> = bytes.chunks_exact(padded as usize).map(|line| &line[..row as usize]).collect();
    Ok(lines.concat())
}

/// The bytes of a buffer that can be copied from.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let descriptor = wgpu::BufferDescriptor {
        label: Some("read back"),
        size: buffer.size(),
        usage,
        mapped_at_creation: false,
    };
    let readable = gpu.device.create_buffer(&descriptor);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &readable, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read_mapped(gpu, &readable)
}

/// What is in a buffer that can be mapped for reading.
pub(super) fn read_mapped(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let failed = |reason: String| GpuError::Driver { doing: "reading back".into(), reason };
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the answer is there.
        let _ = sender.send(result);
    });
    gpu.wait("reading back")?;
    let mapped = receiver.recv().map_err(|error| failed(error.to_string()))?;
    mapped.map_err(|error| failed(error.to_string()))?;
    let view = buffer.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    Ok(view.to_vec())
}
