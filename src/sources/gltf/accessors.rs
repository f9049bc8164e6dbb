//! Numbers in the buffers of a glTF document.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{self, Accessor};

use super::File;

/// Where numbers lie, and of which kind they are.
struct Layout {
    component: ComponentType,
    /// Components of one value.
    components: usize,
    is_normalised: bool,
}

impl File<'_> {
    /// The values of an accessor, as many components each as asked for: of more the first are taken, fewer are refused. Integers that are
    /// normalised become fractions.
    pub(super) fn floats<const N: usize>(
        &self,
        index: json::Index<Accessor>,
    ) -> Result<Vec<[f32; N]>, String> {
        self.values(index, |layout, bytes| {
            if layout.components < N {
                return None;
            }
            let size = layout.component.size();
            Some(std::array::from_fn(|place| {
                float(layout.component, layout.is_normalised, &bytes[place * size..(place + 1) * size])
            }))
        })
    }

    /// How many components a value of an accessor has.
    pub(super) fn components(&self, index: json::Index<Accessor>) -> usize {
        let kind = self.root.get(index).and_then(|accessor| match accessor.type_ {
            Checked::Valid(kind) => Some(kind),
            Checked::Invalid => None,
        });
        kind.map_or(0, |kind| kind.multiplicity())
    }

    /// The values of an accessor of indices.
    pub(super) fn indices(&self, index: json::Index<Accessor>) -> Result<Vec<u32>, String> {
        self.values(index, |layout, bytes| match layout.component {
            ComponentType::U8 => Some(bytes[0].into()),
            ComponentType::U16 => Some(u16::from_le_bytes([bytes[0], bytes[1]]).into()),
            ComponentType::U32 => Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            _ => None,
        })
    }

    /// Reads the values of an accessor, sparse ones too.
    fn values<T: Clone>(
        &self,
        index: json::Index<Accessor>,
        value: impl Fn(&Layout, &[u8]) -> Option<T>,
    ) -> Result<Vec<T>, String> {
        let place = index.value();
        let accessor = self.root.get(index).ok_or_else(|| format!("there is no accessor {place}"))?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err(format!("accessor {place} is of no type that there is"));
        };
        let layout = Layout {
            component: component.0,
            components: kind.multiplicity(),
            is_normalised: accessor.normalized,
        };
        let unfit = || {
            format!("accessor {place} of {} {} is of the wrong type", name(layout.component), kind_name(kind))
        };
        let zero = value(&layout, &[0; 64]).ok_or_else(unfit)?;
        let count = accessor.count.0;
        let mut values = Vec::new();
        if let Some(view) = accessor.buffer_view {
            let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
            let bytes = self.strided(view, offset, count, layout.bytes())?;
            values = bytes.map(|bytes| value(&layout, bytes)).collect::<Option<_>>().ok_or_else(unfit)?;
        } else if let Some(sparse) = &accessor.sparse {
            // No more zeros than what is there warrants: the count alone may say anything.
            let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
            let there = self.strided(view, offset, sparse.count.0, layout.bytes())?.count() as u64;
            if count > FEW_ZEROS + there * MOST_ZEROS {
                return Err(format!("accessor {place}: {count} values, of which {there} are there"));
            }
            values = vec![zero; count as usize];
        }
        if let Some(sparse) = &accessor.sparse {
            self.replace(place, sparse, &layout, &mut values, value)?;
        }
        Ok(values)
    }

    /// Puts the values of a sparse accessor in.
    fn replace<T>(
        &self,
        place: usize,
        sparse: &json::accessor::sparse::Sparse,
        layout: &Layout,
        values: &mut [T],
        value: impl Fn(&Layout, &[u8]) -> Option<T>,
    ) -> Result<(), String> {
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(format!("accessor {place}: sparse indices of no type that there is"));
        };
        let size = component.0.size();
        let indices =
            self.strided(sparse.indices.buffer_view, sparse.indices.byte_offset.0, sparse.count.0, size)?;
        let replacing = self.strided(
            sparse.values.buffer_view,
            sparse.values.byte_offset.0,
            sparse.count.0,
            layout.bytes(),
        )?;
        for (index, bytes) in indices.zip(replacing) {
            let mut number = [0; 4];
            number[..size].copy_from_slice(index);
            let index = u32::from_le_bytes(number);
            let slot = values.get_mut(index as usize);
            let slot =
                slot.ok_or_else(|| format!("accessor {place}: sparse index {index} is outside of it"))?;
            if let Some(value) = value(layout, bytes) {
                *slot = value;
            }
        }
        Ok(())
    }

    /// The bytes of each of `count` values of `size` bytes in a buffer view.
    fn strided(
        &self,
        view: json::Index<json::buffer::View>,
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, String> {
        let bytes = self.buffers.view(view)?;
        let stride = self.root.get(view).and_then(|view| view.byte_stride).map_or(0, |stride| stride.0);
        let stride = if stride == 0 { size } else { stride };
        let needed = count.checked_sub(1).map_or(Some(0), |before| {
            before.checked_mul(stride as u64)?.checked_add(offset)?.checked_add(size as u64)
        });
        if needed.is_none_or(|needed| needed > bytes.len() as u64) || stride < size {
            let (view, there) = (view.value(), bytes.len());
            return Err(format!(
                "{count} values of {size} bytes, {stride} apart, at {offset} of buffer view {view} of {there} bytes"
            ));
        }
        let start = (offset as usize).min(bytes.len());
        Ok((0..count as usize)
            .map(move |value| &bytes[start + value * stride..start + value * stride + size]))
    }
}

/// Zeros of a sparse accessor without a base, at most: so many, and so many more for each value that replaces one.
const FEW_ZEROS: u64 = 1 << 16;
const MOST_ZEROS: u64 = 64;

impl Layout {
    fn bytes(&self) -> usize {
        self.components * self.component.size()
    }
}

/// A component as a number; normalised as glTF 2.0, 3.6.2.2 says.
fn float(component: ComponentType, is_normalised: bool, bytes: &[u8]) -> f32 {
    let two = || [bytes[0], bytes[1]];
    let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
    let (number, greatest) = match component {
        ComponentType::I8 => (f32::from(bytes[0] as i8), 127.0),
        ComponentType::U8 => (f32::from(bytes[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes(two())), 32_767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes(two())), 65_535.0),
        ComponentType::U32 => (u32::from_le_bytes(four()) as f32, u32::MAX as f32),
        ComponentType::F32 => return f32::from_le_bytes(four()),
    };
    if is_normalised { (number / greatest).max(-1.0) } else { number }
}

fn name(component: ComponentType) -> &'static str {
    match component {
        ComponentType::I8 => "BYTE",
        ComponentType::U8 => "UNSIGNED_BYTE",
        ComponentType::I16 => "SHORT",
        ComponentType::U16 => "UNSIGNED_SHORT",
        ComponentType::U32 => "UNSIGNED_INT",
        ComponentType::F32 => "FLOAT",
    }
}

fn kind_name(kind: Type) -> &'static str {
    match kind {
        Type::Scalar => "SCALAR",
        Type::Vec2 => "VEC2",
        Type::Vec3 => "VEC3",
        Type::Vec4 => "VEC4",
        Type::Mat2 => "MAT2",
        Type::Mat3 => "MAT3",
        Type::Mat4 => "MAT4",
    }
}
