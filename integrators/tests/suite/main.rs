//! Declared properties of the methods compared with exact solutions. One binary, one module per question.

#![allow(clippy::print_stdout)] // measured numbers belong to the log of a test run

mod contact_order;
mod dense_output;
mod energy_and_momentum;
mod equilibrium;
mod events;
mod failures;
mod free_flight;
mod golden_work;
mod hammer;
mod linear_oscillator;
mod modal;
mod modes;
mod observers;
mod pieces;
mod problems;
mod quasi_static_correction;
mod smooth_order;
