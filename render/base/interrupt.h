#pragma once

namespace gladstone {

/// Makes SIGINT and SIGTERM set a flag that long work polls. Called once, by main.
void catch_interrupts();

/// Throws Interrupted when the user has asked to stop. Cheap: an atomic load.
void throw_if_interrupted();

}  // namespace gladstone
