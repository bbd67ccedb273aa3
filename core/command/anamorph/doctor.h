// SPDX-License-Identifier: Apache-2.0
// What the hosts of this machine see of Anamorph.
#pragma once

#include <ostream>

namespace anamorph::command {

/// Looks for OpenImageIO's tools and Python module, VTK and ParaView, has each say what it loads, and prints
/// that, with what to do where it is not right. Returns whether all hosts that are there read recipes, and
/// filters that are installed can be loaded. Throws Error where programs cannot be run.
bool examine_hosts(std::ostream& out);

}  // namespace anamorph::command
