// SPDX-License-Identifier: Apache-2.0
// All surfaces, one line each, in the order of menus and documentation. Each has a file of its own, with a class
// that is made of a SurfaceShape and has the formula `point(u, v)`, a template over the number, and, where that is once
// continuously differentiable, `normal(u, v)`, the unit normal along which reliefs are raised. Included where
// ANAMORPH_SURFACE(name, Type) says what to make of them.
ANAMORPH_SURFACE(plane, Plane)
ANAMORPH_SURFACE(cylinder, Cylinder)
ANAMORPH_SURFACE(sphere, Sphere)
ANAMORPH_SURFACE(torus, Torus)
ANAMORPH_SURFACE(page_turn, PageTurn)
ANAMORPH_SURFACE(waves, Waves)
ANAMORPH_SURFACE(ripples, Ripples)
