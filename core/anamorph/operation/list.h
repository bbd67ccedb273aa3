// SPDX-License-Identifier: Apache-2.0
// All operations, one line each, in the order of menus and documentation. Each has a file of its own, which
// defines `const Operation& NAME_operation()`. Included where ANAMORPH_OPERATION says what to make of a name.
ANAMORPH_OPERATION(pano)
ANAMORPH_OPERATION(mosaic)
ANAMORPH_OPERATION(lens)
ANAMORPH_OPERATION(map)
ANAMORPH_OPERATION(warp)
ANAMORPH_OPERATION(morph)
ANAMORPH_OPERATION(drape)
ANAMORPH_OPERATION(figure)
