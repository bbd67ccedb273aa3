# SPDX-License-Identifier: Apache-2.0
"""Textures in scripts."""
from paraview.simple import CreateTexture


def texture_of(name):
    """That of a file. ParaView 5.13 does not tell the server of it before it is updated."""
    texture = CreateTexture(name)
    texture.UpdateVTKObjects()
    return texture
