//! stub
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
/// a
#[derive(Reflect,Clone,Copy,Debug,Default,PartialEq,Eq)]
#[reflect(Default,PartialEq)]
pub enum SampleFormat { /// a
 #[default] U8, /// a
 I8, /// a
 U16, /// a
 I16, /// a
 F32 }
/// a
#[derive(Reflect,Clone,Copy,Debug,Default,PartialEq,Eq)]
#[reflect(Default,PartialEq)]
pub enum Endian { /// a
 #[default] Little, /// a
 Big }
