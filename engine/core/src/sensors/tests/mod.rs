//! Both sensors against exact rays and hand-computed values.

mod bodies;
mod camera;
mod laser;
mod oracle;
mod repeat;
mod shadows;
