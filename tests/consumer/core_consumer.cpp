// SPDX-License-Identifier: Apache-2.0
// A user of the installed core library.
#include <anamorph/version.h>

#include <iostream>

int main() {
    std::cout << "Anamorph " << anamorph::version() << "\n";
    return 0;
}
