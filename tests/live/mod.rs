//! The live page: what it shows, who may ask, and that it can end an exchange.

mod browser;
mod page;
mod viewers;
