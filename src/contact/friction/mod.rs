//! The law of contact: push-out, and Coulomb friction within the budget of the push.

mod budgets;
mod response;

pub(crate) use budgets::FrictionBudget;
pub(crate) use response::{Contact, Impulse, MAX_STEPS, PushOut, first_touch};
