//! A key's name with the type of its value: one constant declares the key and reads it.

use super::{Columns, Key, Nested, Takes, Text, Value, Values};
use crate::double::Double;
use crate::geometry::Attitude;
use crate::quantity::{Kind, Resolution};
use crate::time::SimTime;
use glam::{DMat3, DVec3};
use std::marker::PhantomData;

/// The name of a key whose value is read as `T`: `const RANGE: Name<f64> = Name::new("range");`.
///
/// No table of a scene has two names that are spelled alike.
#[derive(Debug, PartialEq)]
pub struct Name<T: ?Sized>(&'static str, PhantomData<T>);

impl<T: ?Sized> Clone for Name<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: ?Sized> Copy for Name<T> {}

impl<T: ?Sized> From<Name<T>> for &'static str {
    fn from(name: Name<T>) -> &'static str {
        name.0
    }
}

impl Values {
    /// The value of a key; `None` where it is absent and has no default.
    pub fn get<T: Held + ?Sized>(&self, name: Name<T>) -> Option<T::As<'_>> {
        self.0.get(name.0).and_then(T::of)
    }

    /// Removes a key.
    pub fn remove<T: ?Sized>(&mut self, name: Name<T>) {
        self.0.remove(name.0);
    }

    /// Sets a vector.
    pub fn set(&mut self, name: Name<DVec3>, vector: DVec3) {
        self.insert(name.0, Value::Triple(vector.to_array().map(Double::from)));
    }
}

/// What a key's value is read as.
pub trait Held {
    /// By value, or borrowed where it is large.
    type As<'v>;

    /// `None` for a value of another kind.
    fn of(value: &Value) -> Option<Self::As<'_>>;
}

/// `type as what is read: value => reading`.
macro_rules! held {
    ($($type:ty as $read:ty: $value:pat => $reading:expr;)+) => {$(
        impl Held for $type {
            type As<'v> = $read;

            fn of(value: &Value) -> Option<Self::As<'_>> {
                match value {
                    $value => $reading,
                    _ => None,
                }
            }
        }
    )+};
}

held! {
    f64 as f64: Value::Scalar(x) => Some(x.to_f64());
    Double as Double: Value::Scalar(x) => Some(*x);
    DVec3 as DVec3: Value::Triple(v) => Some(DVec3::from_array(v.map(Double::to_f64)));
    [Double; 3] as [Double; 3]: Value::Triple(v) => Some(*v);
    Resolution as Resolution: Value::Resolution(size) => Some(*size);
    SimTime as SimTime: Value::Time(t) => Some(*t);
    &'static str as &'static str: Value::Word(word) => Some(*word);
    [(SimTime, Attitude)] as &'v [(SimTime, Attitude)]: Value::Keyframes(frames) => Some(frames.as_slice());
    Text as &'v Text: Value::File(text) => Some(text);
    Columns as (&'v [String], f64): Value::Columns(names, unit) => Some((names.as_slice(), *unit));
    DMat3 as DMat3: Value::Matrix(matrix) => Some(*matrix);
    bool as bool: Value::Flag(flag) => Some(*flag);
    u64 as u64: Value::Whole(number) => Some(*number);
    Values as &'v Values: Value::Tables(tables) => tables.first();
    [Values] as &'v [Values]: Value::Tables(tables) => Some(tables.as_slice());
}

impl<T: ?Sized> Name<T> {
    /// Of the key that a scene spells so.
    pub const fn new(name: &'static str) -> Name<T> {
        Name(name, PhantomData)
    }

    /// As a scene spells it.
    pub const fn name(self) -> &'static str {
        self.0
    }

    const fn key(self, takes: Takes, about: &'static str) -> Key {
        // The first word stands for an absent one.
        let default = if let Takes::Word(words) = takes { Some(words[0]) } else { None };
        Key { name: self.0, takes, default, about }
    }
}

/// `type: declaration => what the key takes`.
macro_rules! declared {
    ($($type:ty: $how:ident($($argument:ident: $of:ty),*) => $takes:expr;)+) => {$(
        impl Name<$type> {
            #[doc = concat!("Its key, with a line for `list`: it takes `", stringify!($takes), "`.")]
            pub const fn $how(self, $($argument: $of,)* about: &'static str) -> Key {
                self.key($takes, about)
            }
        }
    )+};
}

declared! {
    f64: scalar(kind: Kind) => Takes::Scalar(kind);
    Double: scalar(kind: Kind) => Takes::Scalar(kind);
    DVec3: per_axis(kind: Kind) => Takes::PerAxis(kind);
    DVec3: body_vector(kind: Kind) => Takes::BodyVector(kind);
    DVec3: nav_vector(kind: Kind) => Takes::NavVector(kind);
    [Double; 3]: body_vector(kind: Kind) => Takes::BodyVector(kind);
    Resolution: resolution(kind: Kind) => Takes::Resolution(kind);
    SimTime: duration() => Takes::Duration;
    &'static str: word(words: &'static [&'static str]) => Takes::Word(words);
    [(SimTime, Attitude)]: keyframes() => Takes::Keyframes;
    Text: file() => Takes::File;
    Columns: columns(count: usize, kind: Option<Kind>) => Takes::Columns(Columns { count, kind });
    DMat3: matrix(kind: Kind) => Takes::Matrix(kind);
    bool: flag() => Takes::Flag;
    u64: whole(least: u64, most: u64) => Takes::Whole(least, most);
    Values: table(keys: &'static [Key], alone: Option<&'static str>, example: &'static str) =>
        Takes::Table(Nested { keys, alone, many: false, example });
    [Values]: tables(keys: &'static [Key], example: &'static str) =>
        Takes::Table(Nested { keys, alone: None, many: true, example });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::{FaultKind, SensorKind};
    use crate::wire::PacketFaultKind;
    use crate::{motion, sensor};

    /// Two keys of one name in a table would read each other's values.
    #[test]
    fn no_table_has_two_keys_of_one_name() {
        fn distinct(keys: &[Key]) -> bool {
            let inside = |key: &Key| match key.takes() {
                Takes::Table(nested) => distinct(nested.keys),
                _ => true,
            };
            let again = |(i, key): (usize, &Key)| keys[..i].iter().any(|other| other.name == key.name);
            keys.iter().all(inside) && !keys.iter().enumerate().any(again)
        }
        assert!(!distinct(&[Name::<bool>::new("a").flag(""), Name::<SimTime>::new("a").duration("")]));
        for kind in SensorKind::ALL {
            assert!(distinct(&sensor::keys(kind)), "{kind}");
            assert!(FaultKind::ALL.iter().all(|fault| distinct(&fault.keys(kind))), "a fault of {kind}");
        }
        assert!(motion::KINDS.iter().all(|kind| distinct(kind.keys)), "a motion");
        assert!(PacketFaultKind::ALL.iter().all(|fault| distinct(&fault.keys())), "a fault of an output");
    }

    #[test]
    fn what_a_key_of_another_kind_holds_is_not_read() {
        let (flag, mut values) = (Name::<bool>::new("a"), Values::default());
        assert_eq!(values.get(flag), None);
        values.insert("a", Value::Flag(true));
        assert_eq!((values.get(flag), values.get(Name::<f64>::new("a"))), (Some(true), None));
        values.set(Name::new("a"), DVec3::X);
        assert_eq!((values.get(flag), values.get(Name::<DVec3>::new("a"))), (None, Some(DVec3::X)));
    }
}
