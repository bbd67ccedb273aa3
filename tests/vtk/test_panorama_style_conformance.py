# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphPanoramaStyle where something is missing: an interactor, a window, a renderer, a camera, or what was there when a
# drag began; and objects that go in any order. Without a display: nothing is drawn.
import gc
import itertools
import os

import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkWeakReference
from vtkmodules.vtkRenderingCore import vtkCamera, vtkRenderer, vtkRenderWindow, vtkRenderWindowInteractor

import anamorph

os.environ.pop("DISPLAY", None)
NONE, ROTATE, DOLLY = 0, 1, 4  # what a style is at
PRESSES = ("OnLeftButtonDown", ROTATE), ("OnRightButtonDown", DOLLY)
EVENTS = ("OnMouseMove", "OnLeftButtonDown", "OnMouseMove", "OnLeftButtonUp", "OnRightButtonDown", "OnMouseMove", "OnRightButtonUp",
          "OnMouseWheelForward", "OnMouseWheelForward", "OnMouseWheelBackward", "OnKeyPress", "OnChar")


class Parts:
    """A style with an interactor, and a window with a renderer; not started."""

    def __init__(self, window=True, renderer=True):
        self.style, self.interactor = anamorph.vtkAnamorphPanoramaStyle(), vtkRenderWindowInteractor()
        self.window = vtkRenderWindow() if window else None
        self.renderer = vtkRenderer() if renderer else None
        if self.window:
            self.window.SetOffScreenRendering(1)
            self.window.SetSize(200, 100)
            self.interactor.SetRenderWindow(self.window)
        if self.renderer:
            self.window.AddRenderer(self.renderer)
        self.interactor.SetInteractorStyle(self.style)
        self.move(50, 50)

    def move(self, x, y):
        self.interactor.SetEventInformation(x, y, 0, 0, "a", 0, "Right")

    def gone_on(self):
        """The mouse moves and is let go."""
        self.move(90, 70)
        self.style.OnMouseMove()
        self.style.OnLeftButtonUp()
        self.style.OnRightButtonUp()
        self.style.Look()


def view_of(style):
    return style.GetYaw(), style.GetPitch(), style.GetFieldOfView()


def without_an_interactor_nothing_happens():
    for event in EVENTS:
        style = anamorph.vtkAnamorphPanoramaStyle()
        getattr(style, event)()
        assert view_of(style) == (0, 0, 90) and style.GetState() == NONE, event


def without_a_renderer_no_drag_begins():
    for parts in (Parts(window=False, renderer=False), Parts(renderer=False)):
        for event, _ in PRESSES:
            getattr(parts.style, event)()
            assert parts.style.GetState() == NONE
            parts.gone_on()
        assert view_of(parts.style) == (0, 0, 90)
        # Wheel and keys are for observers.
        for event in EVENTS:
            getattr(parts.style, event)()
        assert parts.style.GetYaw() > 0 and abs(parts.style.GetFieldOfView() - 90 / 1.1) < 1e-9


def events_before_the_start_turn_a_new_camera():
    parts = Parts()
    assert not parts.renderer.IsActiveCameraCreated()
    parts.style.OnLeftButtonDown()
    assert parts.style.GetState() == ROTATE
    parts.gone_on()
    yaw, pitch, _ = view_of(parts.style)
    assert parts.style.GetState() == NONE and yaw < 0 < pitch + 90 and pitch != 0
    assert parts.renderer.IsActiveCameraCreated()
    away = parts.renderer.GetActiveCamera().GetDirectionOfProjection()
    assert away[0] < 0 and away[1] * pitch > 0 and away[2] < 0, away
    # A camera in its place is turned next.
    parts.renderer.SetActiveCamera(vtkCamera())
    parts.style.Look()
    assert all(abs(a - b) < 1e-12 for a, b in zip(parts.renderer.GetActiveCamera().GetDirectionOfProjection(), away))


def a_drag_outlives_what_it_began_in():
    for event, state in PRESSES:
        for part in ("interactor", "style of the interactor", "window", "renderer"):
            parts = Parts()
            getattr(parts.style, event)()
            assert parts.style.GetState() == state
            interactor = parts.interactor
            if part == "interactor":
                interactor.SetInteractorStyle(None)
                parts.interactor = vtkRenderWindowInteractor()
                del interactor
            elif part == "style of the interactor":
                parts.style.SetInteractor(None)
            elif part == "window":
                interactor.SetRenderWindow(None)
                parts.window = None
            else:
                parts.window.RemoveRenderer(parts.renderer)
                parts.renderer = None
            gc.collect()
            parts.gone_on()
            assert parts.style.GetState() == NONE, (event, part)
    # And goes on where all is back.
    parts = Parts()
    parts.style.OnLeftButtonDown()
    parts.style.SetInteractor(None)
    parts.gone_on()
    parts.style.SetInteractor(parts.interactor)
    before = view_of(parts.style)
    parts.move(10, 10)
    parts.style.OnMouseMove()
    assert view_of(parts.style) == before, "no drag"
    parts.style.OnLeftButtonDown()
    parts.move(20, 10)
    parts.style.OnMouseMove()
    assert view_of(parts.style) != before


def parts_go_in_any_order():
    names = ("style", "interactor", "window", "renderer")
    for order in itertools.permutations(names):
        parts = Parts()
        parts.style.OnLeftButtonDown()
        parts.move(60, 60)
        parts.style.OnMouseMove()
        left = [vtkWeakReference() for _ in names]
        for reference, name in zip(left, names):
            reference.Set(getattr(parts, name))
        for name in order:
            delattr(parts, name)
            gc.collect()
        assert all(reference.Get() is None for reference in left), order


without_an_interactor_nothing_happens()
without_a_renderer_no_drag_begins()
events_before_the_start_turn_a_new_camera()
a_drag_outlives_what_it_began_in()
parts_go_in_any_order()
