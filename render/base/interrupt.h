#pragma once

namespace gladstone {

/// Makes SIGINT (Ctrl-C), SIGTERM and SIGHUP (a terminal that is closed; not under nohup) set a flag that long work
/// polls. A second Ctrl-C ends the process at once, whatever blocks; what it leaves, the next run clears away. Called
/// once, by main.
void catch_interrupts();

/// Throws Interrupted when the user has asked to stop. Cheap: an atomic load.
void throw_if_interrupted();

}  // namespace gladstone
