// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Lets ParaView's window know the widgets that panels of this plugin have, of a library beside it. Does nothing in programs without a window.
void load_panel();
