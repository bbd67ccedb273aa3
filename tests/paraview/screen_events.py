# SPDX-License-Identifier: Apache-2.0
"""The mouse and the picture of an X display, by libX11 and libXtst: what a person does and sees."""
import ctypes
import time

import numpy as np


class XImage(ctypes.Structure):
    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("xoffset", ctypes.c_int), ("format", ctypes.c_int),
                ("data", ctypes.c_void_p), ("byte_order", ctypes.c_int), ("bitmap_unit", ctypes.c_int),
                ("bitmap_bit_order", ctypes.c_int), ("bitmap_pad", ctypes.c_int), ("depth", ctypes.c_int),
                ("bytes_per_line", ctypes.c_int), ("bits_per_pixel", ctypes.c_int)]


class Screen:
    def __init__(self):
        self.x11, self.test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
        self.x11.XOpenDisplay.restype = ctypes.c_void_p
        self.x11.XDefaultRootWindow.restype = ctypes.c_ulong
        self.x11.XGetImage.restype = ctypes.POINTER(XImage)
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(None))
        assert self.display, "there is no display"
        self.root = ctypes.c_ulong(self.x11.XDefaultRootWindow(self.display))

    def picture(self, width=1280, height=1024):
        """The pixels of the screen: rows from the top, of red, green and blue."""
        image = self.x11.XGetImage(self.display, self.root, 0, 0, width, height, ctypes.c_ulong(0xffffffff), 2).contents
        assert image.bits_per_pixel == 32, image.bits_per_pixel
        data = ctypes.string_at(image.data, image.bytes_per_line * height)
        return np.frombuffer(data, np.uint8).reshape(height, image.bytes_per_line // 4, 4)[:, :width, 2::-1]

    def move(self, x, y):
        self.test.XTestFakeMotionEvent(self.display, -1, int(x), int(y), ctypes.c_ulong(0))
        self.x11.XSync(self.display, 0)
        time.sleep(0.1)

    def button(self, down, number=1):
        self.test.XTestFakeButtonEvent(self.display, number, int(down), ctypes.c_ulong(0))
        self.x11.XSync(self.display, 0)
        time.sleep(0.2)

    def key(self, symbol, down):
        code = self.x11.XKeysymToKeycode(self.display, ctypes.c_ulong(symbol))
        self.test.XTestFakeKeyEvent(self.display, code, int(down), ctypes.c_ulong(0))
        self.x11.XSync(self.display, 0)
        time.sleep(0.2)

    def focus(self):
        """Lets the window under the pointer have the keys."""
        root, child, number, mask = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_int(), ctypes.c_uint()
        self.x11.XQueryPointer(self.display, self.root, ctypes.byref(root), ctypes.byref(child), *[ctypes.byref(number)] * 4,
                               ctypes.byref(mask))
        self.x11.XSetInputFocus(self.display, child, 1, ctypes.c_ulong(0))
        self.x11.XSync(self.display, 0)
        time.sleep(0.5)

    def type(self, text):
        """Types into the window under the pointer, and presses Return."""
        self.focus()
        for symbol in [*map(ord, text), 0xff0d]:
            self.key(symbol, True)
            self.key(symbol, False)

    def drag(self, start, end, steps=8):
        self.move(*start)
        self.move(start[0] + 1, start[1])
        self.move(*start)
        self.button(True)
        for i in range(1, steps + 1):
            self.move(*(a + (b - a) * i / steps for a, b in zip(start, end)))
        self.button(False)

    def focus_top(self):
        """Lets the window that is on top have the keys."""
        parent, children, count = ctypes.c_ulong(), ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
        root = ctypes.c_ulong()
        self.x11.XQueryTree(self.display, self.root, ctypes.byref(root), ctypes.byref(parent), ctypes.byref(children),
                            ctypes.byref(count))
        self.x11.XSetInputFocus(self.display, ctypes.c_ulong(children[count.value - 1]), 1, ctypes.c_ulong(0))
        self.x11.XSync(self.display, 0)
        time.sleep(0.5)

    def close_dialog(self):
        """Presses Escape in the window that is on top, if it is none of the program's main ones."""
        self.focus_top()
        escape = self.x11.XKeysymToKeycode(self.display, ctypes.c_ulong(0xff1b))
        for down in (1, 0):
            self.test.XTestFakeKeyEvent(self.display, escape, down, ctypes.c_ulong(0))
            self.x11.XSync(self.display, 0)
        time.sleep(1)
