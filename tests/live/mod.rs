//! The live page: contents, access control, and stopping an exchange.

mod browser;
mod page;
mod viewers;
