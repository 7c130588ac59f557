//! Tests of the public interface, in one binary, so that generic code is compiled and optimised once.

mod bodies;
mod camera;
mod contact;
mod drives;
mod imperfection;
mod lone;
mod motion;
mod objects;
mod place;
mod presence;
mod pushing;
mod range;
mod script;
mod sensor;
mod sliding;
mod snapshot;
