// SPDX-License-Identifier: Apache-2.0
#include "load_panel.h"

#include <dlfcn.h>

#include <QCoreApplication>
#include <QFileInfo>
#include <QLibrary>

void load_panel() {
    Dl_info plugin;
    if (!QCoreApplication::instance() || dladdr(reinterpret_cast<void*>(&load_panel), &plugin) == 0) return;
    QLibrary panel(QFileInfo(plugin.dli_fname).absolutePath() + "/panel/AnamorphPanel.so");
    if (const QFunctionPointer add = panel.resolve("anamorph_add_panel"))
        add();
    else
        qWarning("Anamorph: %s; tables are ParaView's own", qUtf8Printable(panel.errorString()));
}
