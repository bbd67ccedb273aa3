// SPDX-License-Identifier: Apache-2.0
// What the plugin calls once it has loaded this library.
#include <QCoreApplication>
#include <QTimer>

#include "pqAnamorphBumpTablePWIImplementation.h"
#include "pqAnamorphNamedWeightsPWIImplementation.h"
#include "pqApplicationCore.h"
#include "pqInterfaceTracker.h"

namespace {

void add_to_window() {
    pqApplicationCore* const core = pqApplicationCore::instance();
    core->interfaceTracker()->addInterface(new pqAnamorphBumpTablePWIImplementation(core));
    core->interfaceTracker()->addInterface(new pqAnamorphNamedWeightsPWIImplementation(core));
}

}  // namespace

extern "C" Q_DECL_EXPORT void anamorph_add_panel() {
    if (pqApplicationCore::instance())
        add_to_window();
    else  // plugins of PV_PLUGIN_PATH are loaded before that is made
        QTimer::singleShot(0, QCoreApplication::instance(), [] {
            if (pqApplicationCore::instance()) add_to_window();
        });
}
