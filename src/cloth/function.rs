//! Functions that a game gives to components.

/// Defines the type of a shared function. Two are equal if they are the same one; the default returns `$none`.
macro_rules! define_function {
    (
        $(#[$doc:meta])* $name:ident,
        $(#[$doc_of_new:meta])* $call:ident($($argument:ident: $kind:ty),+) -> $out:ty, $none:expr
    ) => {
        $(#[$doc])*
        #[derive(Clone)]
        pub struct $name(std::sync::Arc<dyn Fn($($kind),+) -> $out + Send + Sync>);

        impl $name {
            $(#[$doc_of_new])*
            pub fn new($call: impl Fn($($kind),+) -> $out + Send + Sync + 'static) -> Self {
                Self(std::sync::Arc::new($call))
            }

            pub(crate) fn $call(&self, $($argument: $kind),+) -> $out {
                (self.0)($($argument),+)
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::new(|$(_: $kind),+| $none)
            }
        }

        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("..")
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                std::sync::Arc::ptr_eq(&self.0, &other.0)
            }
        }
    };
}
pub(super) use define_function;
