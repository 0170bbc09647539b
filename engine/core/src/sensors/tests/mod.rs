//! Both sensors against exact rays and hand-computed values.

mod bodies;
mod camera;
mod depth;
mod laser;
mod oracle;
mod repeat;
mod shadows;
