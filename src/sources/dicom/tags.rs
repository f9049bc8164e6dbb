//! The elements that are read, by the names that the standard gives them.

macro_rules! tags {
    ($($constant:ident $tag:literal $name:literal)*) => {
        $(#[doc = $name] pub(super) const $constant: u32 = $tag;)*

        /// What an element is called; `None` if it is not read.
        pub(super) fn name(tag: u32) -> Option<&'static str> {
            match tag { $($tag => Some($name),)* _ => None }
        }
    };
}

tags! {
    REFERENCED_FILE 0x0004_1500 "ReferencedFileID"
    DIRECTORY 0x0004_1220 "DirectoryRecordSequence"
    MODALITY 0x0008_0060 "Modality"
    DESCRIPTION 0x0008_103e "SeriesDescription"
    THICKNESS 0x0018_0050 "SliceThickness"
    BETWEEN 0x0018_0088 "SpacingBetweenSlices"
    IMAGER_SPACING 0x0018_1164 "ImagerPixelSpacing"
    SCANNED_SPACING 0x0018_2010 "NominalScannedPixelSpacing"
    SERIES 0x0020_000e "SeriesInstanceUID"
    SERIES_NUMBER 0x0020_0011 "SeriesNumber"
    ACQUISITION 0x0020_0012 "AcquisitionNumber"
    INSTANCE 0x0020_0013 "InstanceNumber"
    POSITION 0x0020_0032 "ImagePositionPatient"
    ORIENTATION 0x0020_0037 "ImageOrientationPatient"
    TEMPORAL 0x0020_0100 "TemporalPositionIdentifier"
    SLICE_LOCATION 0x0020_1041 "SliceLocation"
    STACK 0x0020_9056 "StackID"
    FRAME_CONTENT 0x0020_9111 "FrameContentSequence"
    PLANE_POSITION 0x0020_9113 "PlanePositionSequence"
    PLANE_ORIENTATION 0x0020_9116 "PlaneOrientationSequence"
    TEMPORAL_INDEX 0x0020_9128 "TemporalPositionIndex"
    CHANNELS 0x0028_0002 "SamplesPerPixel"
    PHOTOMETRIC 0x0028_0004 "PhotometricInterpretation"
    PLANAR 0x0028_0006 "PlanarConfiguration"
    FRAMES 0x0028_0008 "NumberOfFrames"
    ROWS 0x0028_0010 "Rows"
    COLUMNS 0x0028_0011 "Columns"
    SPACING 0x0028_0030 "PixelSpacing"
    ASPECT 0x0028_0034 "PixelAspectRatio"
    BITS 0x0028_0100 "BitsAllocated"
    STORED_BITS 0x0028_0101 "BitsStored"
    HIGH_BIT 0x0028_0102 "HighBit"
    SIGNED 0x0028_0103 "PixelRepresentation"
    WINDOW_CENTER 0x0028_1050 "WindowCenter"
    WINDOW_WIDTH 0x0028_1051 "WindowWidth"
    INTERCEPT 0x0028_1052 "RescaleIntercept"
    SLOPE 0x0028_1053 "RescaleSlope"
    RED_LAYOUT 0x0028_1101 "RedPaletteColorLookupTableDescriptor"
    GREEN_LAYOUT 0x0028_1102 "GreenPaletteColorLookupTableDescriptor"
    BLUE_LAYOUT 0x0028_1103 "BluePaletteColorLookupTableDescriptor"
    RED 0x0028_1201 "RedPaletteColorLookupTableData"
    GREEN 0x0028_1202 "GreenPaletteColorLookupTableData"
    BLUE 0x0028_1203 "BluePaletteColorLookupTableData"
    MODALITY_LUT 0x0028_3000 "ModalityLUTSequence"
    PIXEL_MEASURES 0x0028_9110 "PixelMeasuresSequence"
    FRAME_VOI 0x0028_9132 "FrameVOILUTSequence"
    PIXEL_VALUES 0x0028_9145 "PixelValueTransformationSequence"
    DETECTOR 0x0054_0022 "DetectorInformationSequence"
    SLICE_VECTOR 0x0054_0080 "SliceVector"
    SEGMENTATION 0x0062_0001 "SegmentationType"
    SEGMENTS 0x0062_0002 "SegmentSequence"
    SEGMENT 0x0062_0004 "SegmentNumber"
    SEGMENT_LABEL 0x0062_0005 "SegmentLabel"
    SEGMENT_OF_FRAME 0x0062_000a "SegmentIdentificationSequence"
    REFERENCED_SEGMENT 0x0062_000b "ReferencedSegmentNumber"
    SEGMENT_COLOUR 0x0062_000d "RecommendedDisplayCIELabValue"
    GREATEST_FRACTION 0x0062_000e "MaximumFractionalValue"
    OFFSETS 0x3004_000c "GridFrameOffsetVector"
    DOSE_SCALING 0x3004_000e "DoseGridScaling"
    SHARED_GROUPS 0x5200_9229 "SharedFunctionalGroupsSequence"
    FRAME_GROUPS 0x5200_9230 "PerFrameFunctionalGroupsSequence"
    EXTENDED_OFFSETS 0x7fe0_0001 "ExtendedOffsetTable"
    FLOAT_PIXELS 0x7fe0_0008 "FloatPixelData"
    DOUBLE_PIXELS 0x7fe0_0009 "DoubleFloatPixelData"
    PIXELS 0x7fe0_0010 "PixelData"
}

/// The sequences whose elements are read.
pub(super) fn is_sequence(tag: u32) -> bool {
    matches!(
        tag,
        DIRECTORY
            | FRAME_CONTENT
            | PLANE_POSITION
            | PLANE_ORIENTATION
            | MODALITY_LUT
            | PIXEL_MEASURES
            | FRAME_VOI
            | PIXEL_VALUES
            | DETECTOR
            | SEGMENTS
            | SEGMENT_OF_FRAME
            | SHARED_GROUPS
            | FRAME_GROUPS
    )
}

/// The pixels of a file, of whichever type.
pub(super) fn is_pixels(tag: u32) -> bool {
    matches!(tag, FLOAT_PIXELS | DOUBLE_PIXELS | PIXELS)
}

/// `PixelSpacing (0028,0030)`: how an error calls an element.
pub(super) fn called(tag: u32) -> String {
    let number = format!("({:04x},{:04x})", tag >> 16, tag & 0xffff);
    name(tag).map_or(number.clone(), |name| format!("{name} {number}"))
}
