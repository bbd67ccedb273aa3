# SPDX-License-Identifier: Apache-2.0
"""anamorph hash, draw and join: one hash, however a picture is drawn, stored, shared out, stopped and taken up again. And explain: what it
says is what happens."""
import os
import pathlib
import pty
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

from program_test import PROGRAM, VIEW, ProgramTest, noise_ppm

DOCS = pathlib.Path(os.environ["ANAMORPH_DOCS"])


class Pictures(ProgramTest):
    def test_files_and_recipes_have_one_hash(self):
        for name in ("out.tif", "out.png", "out.ppm"):
            self.ok("draw", "sky.pano", "-o", name)
        self.assertEqual(len(set(self.hash("sky.pano", "out.tif", "out.png"))), 1)
        whole = self.hash("sky.pano")[0]
        for other in ("sky.pano?yaw=30.001", "sky.pano?size=900x701", "sky.pano?filter=nearest", "noise.ppm"):
            self.assertNotEqual(self.hash(other)[0], whole)
        self.assertEqual(self.hash("sky.pano?tile=64")[0], whole)
        self.assertEqual(self.hash("sky.pano?tile=0")[0], whole)
        self.assertEqual(list(self.folder.glob(".*")), [])
        # Environments in EXR, whose writer closes late.
        for to in ("cubemap&size=32", "equirectangular&size=64"):
            self.ok("draw", "noise.ppm.pano?to=" + to, "-o", "environment.exr")
            self.assertGreater((self.folder / "environment.exr").stat().st_size, 1000)

    def test_is_the_hash_that_the_page_says(self):
        """Written out with xxhsum, where it is there."""
        if not shutil.which("xxhsum"):
            self.skipTest("xxhsum is not there")

        def xxh128(data):
            out = subprocess.run(["xxhsum", "-H2"], input=data, capture_output=True, check=True).stdout
            return out.decode().split()[0]

        pixels = (self.folder / "noise.ppm").read_bytes()[-256 * 128 * 3:]
        head = "anamorph hash 1\npicture 0 0 256 128 0 0 256 128\nchannel R uint8\nchannel G uint8\nchannel B uint8\n"
        self.assertEqual(self.hash("noise.ppm")[0], xxh128(head.encode() + bytes.fromhex(xxh128(pixels))))

    def test_a_recipe_says_its_hash(self):
        if not shutil.which("oiiotool"):
            self.skipTest("oiiotool is not there")
        environment = dict(os.environ, OIIO_LIBRARY_PATH=os.environ["ANAMORPH_PLUGINS"], OPENIMAGEIO_PLUGIN_PATH=os.environ["ANAMORPH_PLUGINS"])
        for name, says in (("sky.pano?hash=1", True), ("sky.pano?hash=1&tile=0&mip=1", True), ("sky.pano", False),
                           ("noise.ppm.map?hash=1", True)):
            out = subprocess.run(["oiiotool", "--info", "-v", name], cwd=self.folder, env=environment, capture_output=True, text=True,
                                 timeout=100)
            self.assertEqual(out.returncode, 0, out.stdout + out.stderr)
            said = re.findall('anamorph:hash: "([0-9a-f]*)"', out.stdout)
            self.assertEqual(said, self.hash(name) if says else [])

    def test_parts_make_the_whole(self):
        picture = "sky.pano?size=500x400"
        whole = self.hash(picture)[0]
        for count in (3, 5):  # of 4 tiles
            names = [f"part{count}.{k}" for k in range(1, count + 1)]
            for k, name in enumerate(names, 1):
                self.ok("draw", picture, "--part", f"{k}/{count}", "-o", name)
            self.assertEqual(self.ok("join", *reversed(names)).strip(), whole)
            self.assertEqual(self.ok("join", *names, "-o", "joined.tif").strip(), whole)
            self.assertEqual(self.hash("joined.tif")[0], whole)

    def test_goes_on_where_it_was_stopped(self):
        whole = self.hash("sky.pano")[0]
        arguments = ("draw", "sky.pano", "--part", "1/1", "-o", "part")
        self.ok(*arguments)
        tiles, manifest = self.folder / "part", self.folder / "part.tiles"
        pixels, text = tiles.read_bytes(), manifest.read_bytes()
        # Stopped anywhere: between tiles, in one, in a line; with a line whose tile is lost or was changed.
        lines = [m.end() for m in re.finditer(rb"\n", text)]
        for text_bytes, pixel_bytes in ((lines[-1], 0), (lines[-1], 100000), (lines[-5], len(pixels)), (lines[-5] + 7, 700001),
                                        (40, 30), (0, 0), (0, len(pixels)), (len(text), len(pixels))):
            manifest.write_bytes(text[:text_bytes])
            tiles.write_bytes(pixels[:pixel_bytes])
            self.ok(*arguments)
            self.assertEqual(tiles.read_bytes(), pixels)
            self.assertEqual(manifest.read_bytes(), text)
        tiles.write_bytes(pixels[:500] + b"?" + pixels[501:])
        self.refused("tile 0 has not the hash", "join", "part")
        self.ok(*arguments)
        self.assertEqual(self.ok("join", "part").strip(), whole)
        # What is whole is not drawn again; what is made of another file is.
        self.ok(*arguments)
        self.assertEqual(manifest.read_bytes(), text)
        (self.folder / "noise.ppm").write_bytes(noise_ppm(256, 128)[:-3] + b"\0\0\0")
        os.utime(self.folder / "noise.ppm", ns=(10**18, 10**18))
        self.ok(*arguments)
        self.assertNotEqual(text.split(b"\nspec")[0], manifest.read_bytes().split(b"\nspec")[0])

    def test_killed_it_goes_on(self):
        name = "sky.pano?size=1800x1800&tol=0&filter=bicubic"
        arguments = [PROGRAM, "draw", name, "--part", "2/2", "-o", "half"]
        for wait in (0.2, 0.4):
            process = subprocess.Popen(arguments, cwd=self.folder)
            time.sleep(wait)
            process.send_signal(signal.SIGKILL)
            process.wait()
        self.ok(*arguments[1:])
        self.ok("draw", name, "--part", "1/2", "-o", "other")
        self.assertEqual(self.ok("join", "half", "other").strip(), self.hash(name)[0])

    def test_interrupted_draw_leaves_nothing(self):
        (self.folder / "out.tif").write_text("as it was")
        process = subprocess.Popen([PROGRAM, "draw", "sky.pano?size=20000x20000&tol=0", "-o", "out.tif"], cwd=self.folder)
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), -signal.SIGINT)
        self.assertEqual((self.folder / "out.tif").read_text(), "as it was")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["noise.ppm", "out.tif", "sky.pano"])

    def frame_view(self, number):
        return f"sky.pano?size=90x70&yaw={number}"

    def test_draws_frames_by_numbers_in_the_recipe(self):
        (self.folder / "film").mkdir()
        for jobs in ("1", "3"):
            self.assertEqual(self.ok("draw", self.frame_view("{frame}"), "-o", "film/a.{frame}.png", "--frames", "8-12x2", "--jobs", jobs), "")
            names = ["film/a.0008.png", "film/a.0010.png", "film/a.0012.png"]
            self.assertEqual(sorted(p.name for p in (self.folder / "film").iterdir()), [name[5:] for name in names])
            self.assertEqual(self.hash(*names), self.hash(*(self.frame_view(n) for n in (8, 10, 12))))
            for name in names:
                (self.folder / name).unlink()
        # Names without a place for the number get one; other patterns are those of anamorph figure.
        for pattern, name in (("b.png", "b.0008.png"), ("b%03d.png", "b008.png"), ("b##.png", "b08.png")):
            self.ok("draw", self.frame_view("{frame}"), "-o", pattern, "--frames", "8")
            self.assertTrue((self.folder / name).exists(), name)

    def test_draws_frames_of_films(self):
        (self.folder / "keys.json").write_text('{"keys": {"yaw": [[0, 0], [4, 80]]}}')
        film = "sky.pano?size=90x70&keys=keys.json"
        self.ok("draw", film, "-o", "all.{frame}.png")
        names = [f"all.{n:04}.png" for n in range(5)]
        self.assertEqual(sorted(p.name for p in self.folder.glob("all.*")), names)
        expected = [f"sky.pano?size=90x70&keys=keys.json&frame={n}" for n in range(5)]
        self.assertEqual(self.hash(*names), self.hash(*expected))
        # By the key frame: also beyond what all of it is.
        self.ok("draw", film, "-o", "some.{frame}.png", "--frames", "3-7x4")
        self.assertEqual(self.hash("some.0003.png", "some.0007.png"), [self.hash(expected[3])[0], self.hash(film + "&frame=7")[0]])
        # Of an operation without that key, pictures by their numbers.
        (self.folder / "f.json").write_text('{"features": [{"line": [[10, 10, 90, 90], [20, 10, 90, 80]]}]}')
        self.ok("draw", "m.morph?a=noise.ppm&b=noise.ppm&features=f.json&frames=3", "-o", "m.{frame}.tif", "--frames", "1-2")
        self.assertEqual(sorted(p.name for p in self.folder.glob("m.*")), ["m.0001.tif", "m.0002.tif"])
        self.assertEqual(self.hash("m.0001.tif")[0], self.hash("m.morph?a=noise.ppm&b=noise.ppm&features=f.json&t=0.5")[0])
        self.refused("--frames=1-3: must be from 0 to 2", "draw", "m.morph?a=noise.ppm&b=noise.ppm&features=f.json&frames=3", "-o", "n.tif",
                     "--frames", "1-3")
        self.refused("--frames=0-3: the recipe has one picture", "draw", "m.morph?a=noise.ppm&b=noise.ppm&features=f.json", "-o", "n.tif",
                     "--frames", "0-3")

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not there")
    def test_frames_become_a_film_as_the_page_shows_it(self):
        self.ok("draw", self.frame_view("{frame}"), "-o", "turn.{frame}.png", "--frames", "8-12x2")
        line = re.search(r"(?m)^    (ffmpeg -pattern_type .*)$", (DOCS / "command.md").read_text())[1]
        subprocess.run(["bash", "-euc", line], cwd=self.folder, capture_output=True, check=True, timeout=100)
        counted = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", "turn.mp4"],
                                 cwd=self.folder, capture_output=True, text=True, timeout=50)
        self.assertEqual(counted.stdout.strip().strip(","), "3", counted.stderr)

    def test_refuses_frames(self):
        for frames in ("x", "-1", "3-2", "1-", "1-2x0", "1-2x", "1,2"):
            self.refused("--frames=%s: must be a number such as 7" % frames, "draw", self.frame_view("{frame}"), "-o", "a.png", "--frames=" + frames)
        self.refused("--output=turn.mp4: must be a picture: films are drawn as numbered ones", "draw", self.frame_view("5"), "-o", "turn.mp4")
        self.refused("--output=turn.0008.mp4: must be a picture", "draw", self.frame_view("{frame}"), "-o", "turn.mp4", "--frames", "8")
        self.refused('there is no recipe "nowhere.warp", and the source "nowhere" does not exist', "draw", "nowhere.warp", "-o", "a.png")
        self.refused("--frames: must be given as numbers", "draw", self.frame_view("{frame}"), "-o", "a.png")
        self.refused("--frames: must be given as numbers", "draw", self.frame_view("{frame}"), "-o", "a.png", "--frames", "all")
        self.refused("frame 9: yaw=9x", "draw", self.frame_view("{frame}x"), "-o", "a.png", "--frames", "9")
        self.refused("frame 1: cannot write no/a.0001.png", "draw", self.frame_view("{frame}"), "-o", "no/a.png", "--frames", "1-3")
        self.refused("--part excludes --frames", "draw", "sky.pano", "-o", "a", "--part", "1/2", "--frames", "1")
        for jobs in ("-1", "257"):
            self.refused("--jobs=%s: must be from 0 to 256" % jobs, "draw", "sky.pano", "-o", "a.png", "--jobs=" + jobs)
        self.assertEqual(list(self.folder.glob("a*")), [])

    def test_an_interrupted_film_leaves_whole_frames(self):
        process = subprocess.Popen([PROGRAM, "draw", "sky.pano?size=700x500&yaw={frame}", "-o", "a.{frame}.tif", "--frames", "1-100000", "--jobs", "3"],
                                   cwd=self.folder)
        while not list(self.folder.glob("a.*")):
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), -signal.SIGINT)
        frames = sorted(p.name for p in self.folder.glob("a.*"))
        self.assertEqual(self.hash(*frames), self.hash(*(f"sky.pano?size=700x500&yaw={int(name[2:6])}" for name in frames)))
        self.assertEqual(list(self.folder.glob(".*")), [])

    def on_terminal(self, *arguments):
        """The standard error of a program whose standard error is a terminal."""
        master, slave = pty.openpty()
        process = subprocess.Popen([PROGRAM, *arguments], cwd=self.folder, stderr=slave, stdout=subprocess.DEVNULL)
        os.close(slave)
        text = b""
        while True:
            try:
                text += os.read(master, 4096)
            except OSError:  # how a terminal ends
                break
        os.close(master)
        self.assertEqual(process.wait(), 0, text)
        return text.decode()

    def test_says_how_long_it_will_take_on_a_terminal(self):
        # Of what is drawn within half a second nothing is said: so much is drawn that it takes longer.
        def told_of(commands):
            return next(filter(None, (self.on_terminal("draw", *command, "--jobs", "1") for command in commands)))

        told = told_of([f"sky.pano?size={size}x{size}&tol=0&filter=bicubic", "-o", "big.tif"] for size in (1500, 3000, 6000, 12000))
        self.assertRegex(told, r"\[#+ *\] \d+ of \d+ tiles, \d+:\d\d left")
        self.assertTrue(told.endswith("\r\033[K"), told[-60:])
        told = told_of(["sky.pano?size=400x400&tol=0&yaw={frame}", "-o", "f.tif", "--frames", f"1-{count}"] for count in (20, 200, 2000))
        self.assertRegex(told, r"\[#+ *\] \d+ of 20+ frames, \d+:\d\d left")

    def test_memory_stays_flat(self):
        def peak(size):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
            self.ok("draw", "sky.pano?filter=nearest&size=" + size, "--part", "1/1", "-o", "flat")
            return max(before, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)  # of all children so far

        self.assertLess(peak("8000x6000"), 300000)  # KiB; the picture has 144 MB

    def test_what_is_wrong_is_said(self):
        self.refused("--part=0/3: must be I/N", "draw", "sky.pano", "--part", "0/3", "-o", "x")
        for part in ("4/3", "1", "1/0", "a/b", "1/3x", "-1/3", "1/99999999999", "1/100001", ""):
            self.refused("must be I/N", "draw", "sky.pano", "--part", part, "-o", "x")
        self.assertFalse((self.folder / "x").exists())
        self.refused("nothing.tif", "hash", "nothing.tif")
        self.refused("fov=0", "hash", "sky.pano?fov=0")
        os.mkfifo(self.folder / "pipe")
        for name in ("pipe", "/dev/zero", "."):
            self.refused("not a file but a folder, pipe or device", "hash", name)
        self.refused("out.nothing", "draw", "sky.pano", "-o", "out.nothing")
        self.refused("no/out.tif", "draw", "sky.pano", "-o", "no/out.tif")
        for k in (1, 2, 3):
            self.ok("draw", "sky.pano", "--part", f"{k}/3", "-o", f"p{k}")
        self.refused("part 2 of 3 is missing", "join", "p1", "p3")
        self.refused("part 3 of 3 is missing", "join", "p1", "p2")
        self.refused("is part 1 a second time", "join", "p1", "p1", "p2", "p3")
        self.refused("there is no such file", "join", "p4")
        self.ok("draw", "sky.pano?yaw=1", "--part", "2/3", "-o", "q2")
        self.refused("is a part of another picture", "join", "p1", "q2", "p3")
        # What the recipe says, or what is in its files, may have changed in between.
        recipe, noise = self.folder / "sky.pano", self.folder / "noise.ppm"
        for file, other in ((recipe, VIEW.replace("yaw=30", "yaw=31").encode()), (noise, noise_ppm(256, 128)[:-3] + b"\0\0\0")):
            stat, before = file.stat(), file.read_bytes()
            file.write_bytes(other)
            os.utime(file, ns=(10**18, 10**18))
            self.ok("draw", "sky.pano", "--part", "2/3", "-o", "changed")
            self.refused("changed was drawn when the recipe or its files", "join", "p1", "changed", "p3")
            file.write_bytes(before)
            os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        self.ok("join", "p1", "p2", "p3")
        # What is no part stays.
        for name in ("sky.pano", "noise.ppm"):
            before = (self.folder / name).read_bytes()
            self.refused(name + " is there, and no part", "draw", "sky.pano", "--part", "1/3", "-o", name)
            self.assertEqual((self.folder / name).read_bytes(), before)
        (self.folder / "mine.tiles").write_text("of a floor")
        self.refused("mine.tiles is there, and no part", "draw", "sky.pano", "--part", "1/3", "-o", "mine")
        self.assertFalse((self.folder / "mine").exists())
        manifest = self.folder / "p2.tiles"
        text = manifest.read_text()
        manifest.write_text(text[:-40])
        self.refused("is not finished", "join", "p1", "p2", "p3")
        for broken in ("", "x", text[:60], text.replace("part 2 3", "part 3 2"), text.replace("part 2 3", "part 2 999999999"),
                       text.replace("spec ", "spec 9"), text.replace("\ntiles 4", "\ntiles 5"), text[:-33] + "z" + text[-32:],
                       text + "4 " + 32 * "0" + "\n", text + "4", text[:-1] + " x\n", re.sub("<width>[0-9]*", "<width>-5", text),
                       re.sub("<width>[0-9]*", "<width>2147483647", text), re.sub("<nchannels>[0-9]*", "<nchannels>0", text)):
            manifest.write_text(broken)
            self.refused("p2", "join", "p1", "p2", "p3")

    def test_says_why_a_file_is_cut_off(self):
        def with_little_room():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (50000, 50000))

        for name in ("out.tif", "out.exr", "out.png", "out.ppm", "out.jpg", "out.bmp"):
            for jobs in ("1", "2"):
                status, out, error = self.run_program("draw", "sky.pano", "-o", name, "--jobs", jobs, preexec_fn=with_little_room)
                self.assertEqual((status, out), (1, ""), name)
                self.assertRegex(error.splitlines()[-1], rf"^anamorph: {name}: .*[a-z]{{4}}")  # libpng speaks before
                self.assertFalse((self.folder / name).exists())

    def test_photographs_and_what_they_say_of_themselves(self):
        told = ["--attrib", "oiio:ColorSpace", "sRGB", "--attrib", "Make", "Maker"]
        subprocess.run(["oiiotool", "noise.ppm", *told, "-o", "photo.jpg"], cwd=self.folder, check=True)
        recipe = "photo.jpg.lens?lens=brown:k1=-0.1&fov=60"
        self.ok("draw", recipe, "--part", "1/1", "-o", "p1")
        keep_them = ("out.tif", "out.jpg", "out.exr")
        exact = ("out.tif", "out.png", "out.ppm", "out.bmp", "out.tga", "out.jp2")
        for jobs in ("1", "2"):
            for name in (*exact, "out.jpg", "out.exr", "out.webp"):
                self.ok("draw", recipe, "-o", name, "--jobs", jobs)
            info = subprocess.run(["oiiotool", "--info", "-v", *keep_them], cwd=self.folder, capture_output=True, text=True, check=True).stdout
            self.assertEqual(info.count("Make: \"Maker\""), len(keep_them), info)
            self.assertEqual(len(set(self.hash(recipe, *exact))), 1, jobs)
        self.ok("join", "p1", "-o", "joined.tif")
        self.assertEqual(*self.hash(recipe, "joined.tif"))
        # Of TIFF with float OpenImageIO writes one that cannot be read.
        subprocess.run(["oiiotool", "noise.ppm", "-d", "float", "-o", "float.tif"], cwd=self.folder, check=True)
        self.refused("cannot be", "draw", "float.tif.lens?lens=brown:k1=-0.1&fov=60", "-o", "no.jp2")
        self.assertFalse((self.folder / "no.jp2").exists())

    def test_a_source_that_breaks_while_rows_are_written(self):
        whole = noise_ppm(64, 2048)
        (self.folder / "short.ppm").write_bytes(whole[:len(whole) // 2])
        for jobs in ("1", "2"):
            before = sorted(self.folder.iterdir())
            self.refused("short.ppm", "draw", "short.ppm.lens?lens=brown:k1=0.001&fov=10", "-o", "out.tif", "--jobs", jobs)
            self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_files_are_packed_as_asked(self):
        names, sizes = ["sky.pano"], {}
        for how in (None, "rle", "rle:9", "huffman", "filtered", "fixed", "zip:0", "zip:1", "zip:9", "zip"):
            names.append(f"{how}.png".replace(":", "-"))
            self.ok("draw", "sky.pano", "-o", names[-1], *(["--compression", how] if how else []))
            sizes[how] = (self.folder / names[-1]).stat().st_size
        for how in ("none", "piz", "zip"):
            name = f"{how}.exr"
            self.ok("draw", "sky.pano", "-o", name, "--compression", how)
            sizes["exr " + how] = (self.folder / name).stat().st_size
        self.assertEqual(len(set(self.hash(*names))), 1)
        self.assertEqual(sizes[None], sizes["rle"])
        self.assertLess(sizes["zip"], sizes["zip:1"])
        self.assertGreater(sizes["zip:0"], 900 * 700 * 3)
        self.assertLess(sizes["exr zip"], sizes["exr none"])
        for words in ("", "zap", "zip:", "zip:10", "zip:-1", "zip:4x", "rle:", ":4", "zip:4:4"):
            self.refused("must be one of zip, filtered, huffman, rle, fixed", "draw", "sky.pano", "-o", "no.png", "--compression", words)
            self.assertFalse((self.folder / "no.png").exists())
        for name, words in (("no.exr", "pizz"), ("no.tif", "dwaa"), ("no.jpg", "jpeg:0"), ("no.webp", "lossles"), ("no.exr", "")):
            self.refused("must be one of", "draw", "sky.pano", "-o", name, "--compression", words)
            self.assertFalse((self.folder / name).exists())
        self.refused("must not be given for a file of the format pnm", "draw", "sky.pano", "-o", "no.ppm", "--compression", "zip")
        for name, words in (("yes.tif", "zip:9"), ("yes.tif", "lzw"), ("yes.exr", "dwaa:45"), ("yes.jpg", "jpeg:90"), ("yes.webp", "lossless")):
            self.ok("draw", "sky.pano?size=90x70", "-o", name, "--compression", words)  # WebP takes long
        self.ok("draw", "sky.pano", "--part", "1/1", "-o", "p1")
        self.ok("join", "p1", "-o", "joined.png", "--compression", "zip:1")
        self.assertEqual((self.folder / "joined.png").stat().st_size, sizes["zip:1"])
        self.assertEqual(self.run_program("draw", "sky.pano", "--part", "1/1", "-o", "p1", "--compression", "zip")[0], 1)

    def explained(self, *arguments):
        """The lines of a page by their first words; several of one word are told apart by their number."""
        lines = {}
        for text in self.ok("explain", *arguments).splitlines():
            word, said = text[:18].strip(), text[19:]
            while word in lines:
                word += "'"
            lines[word] = said
        return lines

    def blocks(self, page):
        """The shares of the picture, in percent, and the bounds of each kind of blocks."""
        found = {word: re.match(r"([\d.e-]+)%.*? block(?:s, bound ([\d.e-]+)|, bound ([\d.e-]+))?", said) for word, said in page.items()}
        return {word: (float(m[1]), float(m[2] or m[3] or 0)) for word, m in found.items() if m}

    def test_explains_how_a_picture_is_drawn(self):
        page = self.explained("sky.pano")
        self.assertEqual(page["picture"], "900 x 700, 3 channels, uint8")
        self.assertEqual(page["source"], "noise.ppm, 256 x 128")
        blocks = self.blocks(page)
        self.assertAlmostEqual(sum(share for share, _ in blocks.values()), 100, delta=0.05)
        self.assertEqual(float("%.4g" % float(page["max_error"])), max(bound for _, bound in blocks.values()))
        self.assertLessEqual(float(page["max_error"]), 0.01)
        # All pixels by the formula, and of one map of a morph as of the other.
        exact = self.explained("sky.pano?tol=0")
        self.assertEqual((exact["exact_fraction"], sorted(word.split()[0] for word in self.blocks(exact))[0]), ("1", "direct"))
        part = self.explained("sky.pano", "--crop", "64x32+100+200")
        self.assertEqual(part["part"], "64x32+100+200")
        self.assertAlmostEqual(sum(share for share, _ in self.blocks(part).values()), 100, delta=0.05)
        self.assertNotIn("time", part)
        timed = self.explained("sky.pano", "--time")
        self.assertRegex(timed.pop("time"), r"^opened in [\d.e-]+ s, planned in [\d.e-]+, drawn in [\d.e-]+, of which [\d.e-]+ for reading$")
        self.assertEqual(timed, page)

    def test_explains_what_is_read(self):
        # Straight up, no more than the upper rows are needed: a file that ends behind them will do, and one that lacks the last of
        # them will not.
        (self.folder / "up.pano").write_text("src=noise.ppm\nto=rectilinear\nfov=40\npitch=90\nsize=64x64\nfilter=bilinear\n")
        self.assertEqual(self.explained("up.pano")["level 0"], "rows 0 to 63 of 128, 49.2 kB")
        noise = self.folder / "noise.ppm"
        whole, header = noise.read_bytes(), len(b"P6\n256 128\n255\n")
        before = self.hash("up.pano")
        for count, serves in ((64, True), (63, False)):
            noise.write_bytes(whole[:header + 3 * 256 * count])
            os.utime(noise, ns=(10**18 + count, 10**18 + count))
            if serves:
                self.assertEqual(self.hash("up.pano"), before)
            else:
                self.assertEqual(self.run_program("hash", "up.pano")[0], 1)
        self.assertEqual(self.explained("up.pano?output=stmap")["no level"], "is read")

    def test_explains_other_pictures(self):
        self.ok("draw", "sky.pano?size=128x64&fov=100", "-o", "small.tif")
        page = self.explained("l.lens?lens=brown:k1=-0.05&fov=60&src=sky.pano")
        self.assertEqual(page["chain"], "lens of pano")
        apart = self.explained("sky.pano?concatenate=0&src=(noise.ppm.lens?lens=brown:k1=-0.05&fov=60)")
        self.assertIn("a recipe that is drawn first", apart["source"])
        self.assertIn("tiles", apart["level 0"])
        (self.folder / "f.json").write_text('{"features": [{"line": [[10, 10, 90, 90], [20, 10, 90, 80]]}]}')
        page = self.explained("m.morph?a=noise.ppm&b=noise.ppm&features=f.json&frames=3", "--subimage", "1")
        self.assertTrue(page["picture"].endswith(", one of 3") and "source'" in page, page)
        page = self.explained("noise.ppm.drape?surface=sphere&size=64x64")
        self.assertIn("source", page)

    def test_refuses_to_explain(self):
        for message, arguments in (("RECIPE=noise.ppm: must be the name of a recipe", ["noise.ppm"]),
                                   ("crop=x: must be WIDTHxHEIGHT+X+Y", ["sky.pano", "--crop", "x"]),
                                   ("must be WIDTHxHEIGHT+X+Y", ["sky.pano", "--crop", "9x9+1+1+1"]),
                                   ("must be WIDTHxHEIGHT+X+Y", ["sky.pano", "--crop", "2147483647x2+2147483647+1"]),
                                   ("must be WIDTHxHEIGHT+X+Y", ["sky.pano", "--crop", "0x9+1+1"]),
                                   ("crop=9x9+900+0: must meet the picture, 900x700+0+0", ["sky.pano", "--crop", "9x9+900+0"]),
                                   ("subimage=1: must be an integer from 0 to 0", ["sky.pano", "--subimage", "1"]),
                                   ("subimage=-1", ["sky.pano", "--subimage=-1"]),
                                   ("fov=400", ["sky.pano?fov=400"])):
            self.refused(message, "explain", *arguments)

    def test_says_where_a_program_is_missing(self):
        alone = shutil.copy(PROGRAM, self.folder)
        result = subprocess.run([alone, "hash", "sky.pano"], capture_output=True, text=True, timeout=50)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"^anamorph: .*/anamorph-pictures: No such file .*OpenImageIO alone; Debian: anamorph-openimageio\)\n$")

    def test_parallel_as_the_page_shows_it(self):
        if not shutil.which("parallel"):
            self.skipTest("GNU parallel is not there")
        block = re.search(r"\n\n(    parallel .*\n(?:    .*\n)*)", (DOCS / "hash.md").read_text())[1]
        shutil.copy(self.folder / "sky.pano", self.folder / "view.pano")
        environment = dict(os.environ, PATH=os.path.dirname(PROGRAM) + ":" + os.environ["PATH"])
        result = subprocess.run(["bash", "-euc", block], cwd=self.folder, env=environment, capture_output=True, text=True, timeout=100)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([result.stdout.strip()] + self.hash("sky.tif"), 2 * self.hash("sky.pano"))


if __name__ == "__main__":
    unittest.main()
