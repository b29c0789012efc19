//! One declaration a message: the view, the plain values and their docs follow from its fields.
//!
//! A declaration lists the fields in the order of the wire, each with its doc (meaning, unit), the
//! names of its getter and setter and its type.

/// What a payload of fixed fields needs: `LEN`, `Payload` and `Repr`.
///
/// Before the fields stand the byte order (`little` or `big`), how many bytes the view takes
/// (`exactly` or `at_least` so many as the fields have), and what the docs call the payload.
/// Attributes before `fields` go to `Repr`.
macro_rules! payload {
    (little, $($rest:tt)*) => { payload! { @orders from_le, to_le; $($rest)* } };
    (big, $($rest:tt)*) => { payload! { @orders from_be, to_be; $($rest)* } };

    (@check exactly, $found:expr) => { $crate::Error::check_length(LEN, $found) };
    (@check at_least, $found:expr) => { $crate::Error::check_length(LEN, $found.min(LEN)) };
    (@words exactly) => { "exactly" };
    (@words at_least) => { "at least" };

    (
        @orders $from:ident, $to:ident;
        $check:ident, $($what:expr),+;
        $(#[$len_attribute:meta])* LEN;
        $(#[$attribute:meta])*
        fields { $($(#[$doc:meta])* $name:ident / $set:ident: $kind:ty,)+ }
    ) => {
        $(#[$len_attribute])*
        pub const LEN: usize = size_of::<Wire>();

        /// The fields as they lie on the wire, for their places alone.
        #[repr(C, packed)]
        struct Wire {
            $($name: $kind,)+
        }

        /// A view of the payload's bytes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct Payload<T>(T);

        impl<T: AsRef<[u8]>> Payload<T> {
            #[doc = concat!("Takes `bytes` as ", $($what),+, ".")]
            ///
            /// # Errors
            #[doc = concat!(
                "[`Error::Length`](crate::Error::Length) unless there are ",
                payload!(@words $check),
                " [`LEN`] bytes."
            )]
            pub fn new_checked(bytes: T) -> Result<Self, $crate::Error> {
                payload!(@check $check, bytes.as_ref().len())?;
                Ok(Self(bytes))
            }

            $(
                $(#[$doc])*
                #[inline]
                pub fn $name(&self) -> $kind {
                    $crate::bytes::Field::$from(self.0.as_ref(), core::mem::offset_of!(Wire, $name))
                }
            )+
        }

        impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
            $(
                #[doc = concat!("Sets [`", stringify!($name), "`](Self::", stringify!($name), ").")]
                #[inline]
                pub fn $set(&mut self, value: $kind) {
                    let at = core::mem::offset_of!(Wire, $name);
                    $crate::bytes::Field::$to(value, self.0.as_mut(), at);
                }
            )+
        }

        #[doc = concat!("Plain values of ", $($what),+, ".")]
        ///
        /// ```
        #[doc = concat!("use ", module_path!(), "::{LEN, Payload, Repr};")]
        ///
        /// let repr = Repr::default();
        /// let mut bytes = [0xff; LEN];
        /// repr.emit(&mut Payload::new_checked(&mut bytes)?);
        /// assert_eq!(Repr::parse(&Payload::new_checked(&bytes)?), repr);
        /// # Ok::<(), ratetable_protocols::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $(#[$attribute])*
        pub struct Repr {
            $($(#[$doc])* pub $name: $kind,)+
        }

        impl Repr {
            /// Reads every field of a view.
            pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
                Self { $($name: payload.$name(),)+ }
            }

            /// Bytes that [`emit`](Self::emit) writes.
            pub const fn buffer_len(&self) -> usize {
                LEN
            }

            /// Writes every field into a view.
            #[inline]
            pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
                $(payload.$set(self.$name);)+
            }
        }

        #[cfg(test)]
        impl Repr {
            /// Asserts that each getter reads what is in these values.
            fn assert_read<T: AsRef<[u8]>>(&self, payload: &Payload<T>) {
                $(assert_eq!(payload.$name(), self.$name, stringify!($name));)+
            }

            /// Calls each setter alone and asserts that it writes its own bytes of `golden` and no others.
            fn assert_set(&self, golden: &[u8; LEN]) {
                $({
                    let at = core::mem::offset_of!(Wire, $name);
                    let at = at..at + size_of::<$kind>();
                    let mut bytes = golden.map(|byte| !byte);
                    let mut expected = bytes;
                    expected[at.clone()].copy_from_slice(&golden[at]);
                    Payload::new_checked(&mut bytes).unwrap().$set(self.$name);
                    assert_eq!(bytes, expected, stringify!($name));
                })+
            }
        }
    };
}

/// A MAVLink message: `ID`, `CRC_EXTRA`, `BASE_LEN` and what [`payload`] gives.
///
/// `extensions` are the fields that MAVLink 1 leaves out.
macro_rules! message {
    (
        $title:ident: id $id:literal, crc_extra $crc_extra:literal;
        $(#[$attribute:meta])*
        fields { $($(#[$doc:meta])* $name:ident / $set:ident: $kind:ty,)+ }
        $(extensions { $($(#[$more_doc:meta])* $more:ident / $set_more:ident: $more_kind:ty,)+ })?
    ) => {
        /// The message id.
        pub const ID: u32 = $id;

        /// What the checksum is seeded with after the bytes: guards against a different field list.
        pub const CRC_EXTRA: u8 = $crc_extra;

        /// Bytes without extension fields: the payload in MAVLink 1.
        pub const BASE_LEN: usize = 0 $(+ size_of::<$kind>())+;

        payload! {
            little, exactly, "the payload of `", stringify!($title), "` at full length";
            /// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
            LEN;
            $(#[$attribute])*
            fields {
                $($(#[$doc])* $name / $set: $kind,)+
                $($($(#[$more_doc])* $more / $set_more: $more_kind,)+)?
            }
        }
    };
}

/// The tests of a payload over one array of bytes and the values in it.
#[cfg(test)]
macro_rules! golden_tests {
    ($golden:expr, $repr:expr) => {
        #[test]
        fn deconstruct() {
            $repr.assert_read(&Payload::new_checked(&$golden).unwrap());
            assert!(Payload::new_checked(&$golden[1..]).is_err());
        }

        #[test]
        fn construct() {
            $repr.assert_set(&$golden);
        }

        #[test]
        fn parse() {
            assert_eq!(Repr::parse(&Payload::new_checked(&$golden).unwrap()), $repr);
        }

        #[test]
        fn emit() {
            let mut bytes = [0xff; LEN];
            assert_eq!($repr.buffer_len(), LEN);
            $repr.emit(&mut Payload::new_checked(&mut bytes).unwrap());
            assert_eq!(bytes, $golden);
        }
    };
}
