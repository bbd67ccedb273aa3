# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""What a session had is there again after its state is loaded, as .pvsm and as Python, and after its trace is run;
animation tracks on bumps and weights move the surface; key frames follow the animation's time."""
import os

import surfaces
from paraview import smstate, smtrace
from paraview.simple import *


def names_of(made):
    for name, source in made.items():
        RenameSource(name, source)
    return list(made)


def digests(names):
    return {name: surfaces.digest(surfaces.gather(FindSource(name))) for name in names}


def start_again():
    ResetSession()
    surfaces.LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())


def check_states(folder):
    made = surfaces.make(folder)
    made["deformed"].SelectedDeformation = 1
    names = names_of(made)
    wanted = digests(names)
    assert len(set(wanted.values())) == 5  # two of them are the same surface
    SaveState("session.pvsm")
    session = smstate.get_state()
    start_again()
    LoadState("session.pvsm")
    assert digests(names) == wanted
    deformed = FindSource("deformed")
    assert list(deformed.Deformations) == surfaces.BUMPS
    assert deformed.SelectedDeformation == 1 and list(deformed.SelectedVector) == surfaces.BUMPS[13:16]
    start_again()
    exec(session, {})
    assert digests(names) == wanted


def check_height_array():
    """Which array of a picture is the height is chosen, and kept."""
    start_again()
    picture = Calculator(Input=Wavelet(WholeExtent=[0, 10, 0, 10, 0, 0]), ResultArrayName="flat", Function="0.25")
    picture.UpdatePipeline()
    relief = AnamorphRelief(registrationName="relief", Input=picture, HeightArray=["POINTS", "flat"], HeightScale=2)
    relief.UpdatePipeline()
    assert relief.GetDataInformation().GetBounds()[4:] == (0.5, 0.5)
    relief.HeightArray = ["POINTS", "RTData"]
    SaveState("relief.pvsm")
    start_again()
    LoadState("relief.pvsm")
    relief = FindSource("relief")
    relief.UpdatePipeline()
    assert relief.GetDataInformation().GetBounds()[5] > 2 * 200


def check_trace():
    start_again()
    smtrace.start_trace()
    deform = AnamorphDeform(registrationName="traced", Input=Plane(XResolution=20, YResolution=20),
                            Deformations=surfaces.BUMPS, GenerateOverlay=1)
    AnamorphInbetween(registrationName="between", Input=[deform, deform], Weights=[1.5, -0.5])
    trace = smtrace.stop_trace()
    assert "AnamorphDeform(" in trace and "Weights = [1.5, -0.5]" in trace, trace
    start_again()
    exec(trace, {})
    assert list(FindSource("traced").Deformations) == surfaces.BUMPS
    assert list(FindSource("between").Weights) == [1.5, -0.5]


def track(proxy, name, index, first, last):
    found = GetAnimationTrack(name, index=index, proxy=proxy)
    found.KeyFrames = [CompositeKeyFrame(KeyTime=0, KeyValues=[first]), CompositeKeyFrame(KeyTime=1, KeyValues=[last])]


def heights(scene, source):
    found = []
    for frame in range(3):
        scene.AnimationTime = frame / 2
        source.UpdatePipeline(frame / 2)
        found.append(source.GetDataInformation().GetBounds()[5])
    return found


def check_animation():
    start_again()
    plane = Plane(XResolution=40, YResolution=40)
    bump = AnamorphDeform(Input=plane, Deformations=[0.5, 0.5, 0.1, 0.1, 0, 0, 9, 0, 0] + [0, 0, 0.3, 0.3, 0, 0, 1, 0, 1])
    between = AnamorphInbetween(Input=[plane, bump], Weights=[1, 0])
    scene = GetAnimationScene()
    scene.StartTime, scene.EndTime, scene.PlayMode, scene.NumberOfFrames = 0, 1, "Sequence", 3
    track(bump, "Deformations", 9 + 6, 1, 3)
    assert heights(scene, bump) == [1, 2, 3]
    track(between, "Weights", 0, 1, -0.5)
    track(between, "Weights", 1, 0, 1.5)
    assert heights(scene, between) == [0, 1.5, 4.5]
    keyed = AnamorphInbetween(Input=[plane, bump], Keys=[0, 0, 1, 1, 1, 1, 1, 0, 0])
    keyed.UpdatePipelineInformation()
    assert list(keyed.TimestepValues) == [0, 1]
    assert heights(scene, keyed) == [0, 1, 3]


surfaces.write_inputs(os.getcwd())
check_states(os.getcwd())
check_height_array()
check_trace()
check_animation()
