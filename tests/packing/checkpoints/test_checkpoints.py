"""Checkpoint files, which restore the same bits or are rejected with a reason, and the folder that contains them."""

import copy
import errno
import hashlib
import json
import os
import signal
import struct
import subprocess
import sys
import textwrap
import weakref

import numpy as np
import pytest

from simcore.dem.shapes.polyhedra import Base
from simcore.packing.checkpoints import lock
from simcore.packing.checkpoints.file import CheckpointError, read_checkpoint, write_checkpoint
from simcore.packing.checkpoints.key import scene_key
from simcore.packing.checkpoints.store import Store
from simcore.scene.specification import read_schema, resolve

KEY, CODE = "0123456789abcdef", "0.1.0+fedcba"
HEADER = {"key": KEY, "code": CODE, "step": 7, "time": 0.1, "checks": [[1e-300, "shaking", -0.0]]}


def a_state(n=40, seed=1):
    """Return sections with every type, odd bit patterns, arrays without rows or dimensions and not in C order."""
    rng = np.random.default_rng(seed)
    patterns = np.frombuffer(rng.bytes(8 * n), np.float64).copy()  # any bits, nan payloads among them
    patterns[:5] = np.nan, -0.0, np.inf, -np.inf, 5e-324
    patterns[5:6].view(np.uint64)[:] = 0xFFF4_0000_DEAD_BEEF  # a signalling nan with a sign and a payload
    return [
        {
            "position": rng.normal(size=(n, 3)),
            "patterns": patterns,
            "transposed": rng.normal(size=(3, n)).T,
            "strided": np.arange(4 * n)[::4],
            "big_endian": rng.normal(size=n).astype(">f8"),
            "id": rng.integers(-(2**63), 2**63 - 1, n, np.int64),
            "shape": rng.integers(-(2**31), 2**31 - 1, (n, 2), np.int32),
            "kind": rng.integers(0, 255, n, np.uint8, endpoint=True),
            "touching": rng.random(n) < 0.5,
        },
        {"position": np.zeros((0, 3)), "image": np.zeros((0, 0, 2), np.int64), "touching": np.zeros(0, bool)},
        {},
        {"mean": np.array(-0.0), "größe": np.arange(3, dtype=np.int32)},
    ]


def assert_same_bits(sections, expected):
    assert len(sections) == len(expected)
    for read, written in zip(sections, expected, strict=True):
        assert list(read) == list(written)
        for name, array in written.items():
            native = array.astype(array.dtype.newbyteorder("="))
            assert read[name].dtype == native.dtype and read[name].dtype.isnative
            assert read[name].shape == array.shape
            assert read[name].tobytes() == native.tobytes()
            assert read[name].flags.writeable and read[name].flags.owndata


@pytest.fixture
def written(tmp_path):
    path = tmp_path / "a.checkpoint"
    write_checkpoint(path, HEADER, a_state())
    return path


def refusal(path, key=KEY, code=CODE, **options):
    with pytest.raises(CheckpointError) as refused:
        read_checkpoint(path, key, code, **options)
    message = str(refused.value)
    assert str(path) in message and "\n" not in message
    return message


# -- one file -----------------------------------------------------------------------------------------------


def test_what_is_read_has_the_bits_of_what_was_written(written):
    header, sections = read_checkpoint(written, KEY, CODE)
    assert header == HEADER and str(header["checks"][0][2]) == "-0.0"
    assert_same_bits(sections, a_state())
    assert_same_bits(list(sections), a_state())  # once more: a section is read when it is accessed
    assert [file.name for file in written.parent.iterdir()] == [written.name]


def test_a_checkpoint_without_sections_and_with_numpy_numbers_in_its_header(tmp_path):
    path = tmp_path / "a.checkpoint"
    write_checkpoint(path, HEADER | {"step": np.int64(8), "time": np.float64(0.1), "done": np.bool_(True)}, [])
    header, sections = read_checkpoint(path, KEY, CODE)
    assert header == HEADER | {"step": 8, "time": 0.1, "done": True} and len(sections) == 0


def test_the_same_state_makes_the_same_file(written, tmp_path):
    other = tmp_path / "b.checkpoint"
    write_checkpoint(other, HEADER, iter(a_state()))
    assert other.read_bytes() == written.read_bytes()


def test_a_section_is_released_before_the_next_is_read(tmp_path):
    alive = []

    def sections():
        for _ in range(3):
            assert all(array() is None for array in alive)
            array = np.ones(10)
            alive.append(weakref.ref(array))
            section = {"a": array}
            del array
            yield section
            del section

    write_checkpoint(tmp_path / "a.checkpoint", HEADER, sections())
    assert len(alive) == 3


@pytest.mark.parametrize("array", [np.zeros(2, np.float32), np.array([None]), np.array(["a"]), np.zeros(2, "f8,i8")])
def test_other_types_are_not_written(written, array):
    before = written.read_bytes()
    with pytest.raises(TypeError, match="array odd is of"):
        write_checkpoint(written, HEADER, [{"odd": array}])
    assert [file.name for file in written.parent.iterdir()] == [written.name] and written.read_bytes() == before


def corrupted(whole, rng):
    """Return the bytes of a file with one random fault: flipped bits, a truncation or an insertion."""
    n = len(whole)
    low, high = [(0, 20), (20, 200), (n - 48, n), (0, n)][rng.integers(4)]
    place = int(rng.integers(low, high))
    fault = rng.integers(3)
    if fault == 0:
        return whole[:place] + bytes([whole[place] ^ int(rng.integers(1, 256))]) + whole[place + 1 :]
    if fault == 1:
        return whole[:place]
    return whole[:place] + rng.bytes(int(rng.integers(1, 100))) + whole[place:]


def test_each_of_200_corruptions_is_refused_and_the_older_checkpoint_read_in_its_place(tmp_path):
    lines = []
    with Store(tmp_path, KEY, CODE, lines.append) as store:
        store.save({"step": 1}, a_state(seed=1))
        store.save({"step": 2}, a_state(seed=2))
        newest = tmp_path / f"{KEY}-2.checkpoint"
        whole, rng = newest.read_bytes(), np.random.default_rng(20240607)
        for k in range(200):
            newest.write_bytes(corrupted(whole, rng))
            reason = refusal(newest)
            header, sections = store.latest()
            assert header["step"] == 1 and lines[k:] == [reason]
            assert_same_bits(sections, a_state(seed=1))
        newest.write_bytes(whole)  # the faults were the reason, not the file
        assert store.latest()[0]["step"] == 2 and len(lines) == 200


def test_reasons_of_refusal(written, tmp_path):
    whole = written.read_bytes()
    assert refusal(written, key="f" * 16).count("another scene") == 1
    assert KEY in refusal(written, key="f" * 16)
    assert "another version of the code (0.1.0+fedcba; this run has 0.2.0)" in refusal(written, code="0.2.0")
    assert "schema 1, but this code reads schema 2" in refusal(written, schema=2)
    assert "is a folder" in refusal(tmp_path)
    assert "No such file" in refusal(tmp_path / "none")
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    assert "cannot be read (Too many levels of symbolic links)" in refusal(loop)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert "not a regular file" in refusal(pipe)  # it does not wait for a writer
    for content, reason in [
        (b"", "is empty"),
        (b"\x89HDF\r\n\x1a\n" + whole, "does not start like a checkpoint"),
        (whole[:50], "truncated: it has only 50 bytes"),
        (whole[:-1], "truncated or damaged"),
        (whole + whole, "truncated or damaged"),
        (whole[:300] + bytes([whole[300] ^ 1]) + whole[301:], "its checksum is wrong"),
        (whole[:-1] + bytes([whole[-1] ^ 1]), "its checksum is wrong"),
        (whole[:8] + b"\x02" + whole[9:], "its checksum is wrong"),  # the message does not name another schema
    ]:
        written.write_bytes(content)
        assert reason in refusal(written)


def sealed(header, *tables, schema=1):
    """Return a file of any content with a right checksum. tables: texts, or bytes that are used unchanged."""
    text = json.dumps(header).encode()
    content = struct.pack("<8sIQ", b"SCREE-CP", schema, len(text)) + text
    for table in tables:
        content += table if isinstance(table, bytes) else struct.pack("<Q", len(table)) + table.encode()
    content += struct.pack("<8sQ", b"CP-SCREE", len(content))
    return content + hashlib.sha256(content).digest()


@pytest.mark.parametrize(
    "table",
    [
        '[["a", "float64", [1000000000000]]]',
        '[["a", "float64", [4294967296, 4294967296]]]',
        '[["a", "float64", [0, 4611686018427387904]]]',
        '[["a", "float64", [-1]]]',
        '[["a", "float64", [true]]]',
        '[["a", "float64", [1e300]]]',
        '[["a", "object", [0]]]',
        '[["a", ["float64"], [0]]]',
        f'[["a", "uint8", {[0] * 100}]]',
        '["a"]',
        '{"a": 1}',
        "7",
        "[" * 100_000,
        "not JSON",
        struct.pack("<Q", 2**63),
        struct.pack("<Q", 100) + b"[]",
        b"\x01",
    ],
)
def test_sizes_in_a_header_are_bounded_by_the_length_of_the_file_even_if_the_checksum_is_right(written, table):
    written.write_bytes(sealed(HEADER, "[]"))
    assert len(read_checkpoint(written, KEY, CODE)[1]) == 1
    written.write_bytes(sealed(HEADER, "[]", table))
    assert "its layout is not that of a checkpoint" in refusal(written)


def test_a_header_that_is_none_is_refused(written):
    written.write_bytes(sealed([1, 2]))
    assert "its layout is not that of a checkpoint" in refusal(written)
    written.write_bytes(sealed({}))
    assert "another scene (None" in refusal(written)


def test_sections_stay_readable_when_the_file_is_replaced_and_are_an_error_when_it_shrinks(written):
    _, sections = read_checkpoint(written, KEY, CODE)
    write_checkpoint(written, HEADER, a_state(seed=3))
    assert_same_bits(sections, a_state(seed=1))
    _, sections = read_checkpoint(written, KEY, CODE)
    os.truncate(written, 400)
    with pytest.raises(CheckpointError, match="became shorter"):
        sections[0]


# -- a folder -----------------------------------------------------------------------------------------------


def names(folder, ending=".checkpoint"):
    return sorted(file.name for file in folder.iterdir() if file.name.endswith(ending))


def test_the_two_newest_are_kept_and_other_scenes_left_alone(tmp_path):
    other = Store(tmp_path / "deep" / "folder", "ab", CODE, pytest.fail)
    folder = other.folder
    other.save({"step": 3}, [])
    with Store(folder, KEY, CODE, pytest.fail) as store:
        assert store.latest() is None
        for step in (9, 10, np.int64(11), 11, 100):  # steps count as numbers, and one may be saved twice
            store.save({"step": step}, a_state(seed=int(step)))
            header, sections = store.latest()
            assert header == {"step": step, "key": KEY, "code": CODE}
            assert_same_bits(sections, a_state(seed=int(step)))
            assert len([name for name in names(folder) if name.startswith(KEY)]) == min(2, step - 8)
        assert names(folder) == [f"{KEY}-100.checkpoint", f"{KEY}-11.checkpoint", "ab-3.checkpoint"]
        store.clear()
    assert sorted(file.name for file in folder.iterdir()) == ["ab-3.checkpoint", "ab.lock"]
    other.close()
    assert names(folder, "") == ["ab-3.checkpoint"]


def test_refused_checkpoints_push_no_good_one_out(tmp_path):
    """A run resumed from the older one is at earlier steps than the damaged one; a run of new code at any step."""
    with Store(tmp_path, KEY, CODE, pytest.fail) as store:
        store.save({"step": 100}, [])
        store.save({"step": 200}, [])
    os.truncate(tmp_path / f"{KEY}-200.checkpoint", 30)
    lines = []
    with Store(tmp_path, KEY, CODE, lines.append) as store:
        assert store.latest()[0]["step"] == 100 and len(lines) == 1
        store.save({"step": 150}, [])
        assert names(tmp_path) == [f"{KEY}-100.checkpoint", f"{KEY}-150.checkpoint"]
    with Store(tmp_path, KEY, "0.2.0", lines.append) as store:
        assert store.latest() is None and len(lines) == 3
        store.save({"step": 10}, [])
        assert store.latest()[0]["step"] == 10
        store.save({"step": 20}, [])
        assert names(tmp_path) == [f"{KEY}-10.checkpoint", f"{KEY}-20.checkpoint"]


# Writing beyond this limit fails as on a full disk. Python ignores the signal that this sends, and so does the script.
FULL_DISK = """
    import resource, signal, sys
    import numpy as np
    from simcore.packing.checkpoints.file import CheckpointError
    from simcore.packing.checkpoints.store import Store

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    taken = []

    def sections():
        for k in range(5):
            taken.append(k)
            yield {"a": np.full(40_000, float(k))}

    with Store(sys.argv[1], sys.argv[2], sys.argv[3], print) as store:
        assert store.latest()[0]["step"] == 2
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[4]),) * 2)
        try:
            store.save({"step": 3}, sections())
        except CheckpointError as error:
            print(error)
        assert taken == [0, 1, 2, 3, 4], taken  # also those after the failure: ranks send them
        store.save({"step": 4}, [{"a": np.arange(3)}])
    assert not {"numba", "mpi4py"} & set(sys.modules)
"""


@pytest.mark.parametrize("limit", [4096, 700_000, 1_600_300])  # in the first section, in a later one, at the end
def test_a_full_disk_leaves_the_earlier_checkpoints_and_the_run(tmp_path, limit):
    with Store(tmp_path, KEY, CODE, pytest.fail) as store:
        store.save({"step": 1}, [])
        store.save({"step": 2}, a_state())
    program = [sys.executable, "-c", textwrap.dedent(FULL_DISK), tmp_path, KEY, CODE, str(limit)]
    done = subprocess.run(program, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    assert f"{KEY}-3.checkpoint: the checkpoint could not be written (File too large)" in line
    assert "Free space" in line and "there is none of this step" in line
    assert names(tmp_path, "") == [f"{KEY}-2.checkpoint", f"{KEY}-4.checkpoint"]
    with Store(tmp_path, KEY, CODE, pytest.fail) as store:
        (tmp_path / f"{KEY}-4.checkpoint").unlink()
        assert_same_bits(store.latest()[1], a_state())


def test_a_folder_that_cannot_be_is_said_at_the_start_and_one_that_goes_when_saving(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(CheckpointError, match="file/folder: no checkpoint can be written there"):
        Store(tmp_path / "file" / "folder", KEY, CODE, pytest.fail)
    with Store(tmp_path / "gone", KEY, CODE, pytest.fail) as store:
        (tmp_path / "gone" / f"{KEY}.lock").unlink()
        (tmp_path / "gone").rmdir()
        with pytest.raises(CheckpointError, match="No such file or directory.* there is none of this step"):
            store.save({"step": 1}, a_state())
        assert store.latest() is None
        store.clear()


def test_leftovers_of_a_killed_run_are_removed_by_the_next_of_its_key_alone(tmp_path):
    mine, others, older = f"{KEY}-5.checkpoint.part", f"ab{KEY}-5.checkpoint.part", f"{KEY}-4.checkpoint"
    for name in (mine, others, older, f"{KEY}-5.checkpoint.partly", "notes.txt"):
        (tmp_path / name).write_text("")
    kept = sorted([others, older, f"{KEY}-5.checkpoint.partly", "notes.txt"])
    Store(tmp_path, KEY, CODE, pytest.fail, lock=False)
    assert (tmp_path / mine).exists()  # another process may be writing it
    with Store(tmp_path, KEY, CODE, pytest.fail):
        assert names(tmp_path, "") == sorted([*kept, f"{KEY}.lock"])
    assert names(tmp_path, "") == kept


HOLDER = """
    import sys, time
    from simcore.packing.checkpoints.store import Store

    store = Store(*sys.argv[1:], print)
    print("held", flush=True)
    time.sleep(600)
"""


def test_a_second_process_is_refused_until_the_first_is_dead(tmp_path):
    program = [sys.executable, "-c", textwrap.dedent(HOLDER), tmp_path, KEY, CODE]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as holder:
        try:
            assert holder.stdout.readline() == "held\n"
            with pytest.raises(CheckpointError, match=rf"process {holder.pid} on \S+ runs this scene \({KEY}\)"):
                Store(tmp_path, KEY, CODE, pytest.fail)
            Store(tmp_path, "ab", CODE, pytest.fail).close()
            Store(tmp_path, KEY, CODE, pytest.fail, lock=False).close()
        finally:
            holder.send_signal(signal.SIGKILL)
    assert names(tmp_path, "") == [f"{KEY}.lock"]
    with Store(tmp_path, KEY, CODE, pytest.fail):
        with pytest.raises(CheckpointError, match=f"process {os.getpid()} on"):
            Store(tmp_path, KEY, CODE, pytest.fail)
    Store(tmp_path, KEY, CODE, pytest.fail).clear()
    assert names(tmp_path, "") == []


def test_the_lock_that_counts_is_the_one_that_bears_the_name(tmp_path, monkeypatch):
    """The first process removes its lock file after another process has opened it and before that one locks it."""
    take, first = lock.lock_descriptor, Store(tmp_path, KEY, CODE, pytest.fail)

    def late(file, blocking):
        first.close()
        return take(file, blocking=blocking)

    monkeypatch.setattr(lock, "lock_descriptor", late)
    with Store(tmp_path, KEY, CODE, pytest.fail):
        assert names(tmp_path, "") == [f"{KEY}.lock"]
        with pytest.raises(CheckpointError, match="runs this scene"):
            Store(tmp_path, KEY, CODE, pytest.fail)


def test_a_file_system_without_locks_is_reported_and_used_with_care(tmp_path, monkeypatch):
    def no_lock(file, blocking):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(lock, "lock_descriptor", no_lock)
    part, lines = tmp_path / f"{KEY}-5.checkpoint.part", []
    part.write_text("")
    with Store(tmp_path, KEY, CODE, lines.append) as store:
        store.save({"step": 1}, [])
        assert store.latest()[0]["step"] == 1
    assert len(lines) == 1 and "cannot be locked (No locks available)" in lines[0]
    assert part.exists()  # another process may be writing it


# -- the key of a scene -------------------------------------------------------------------------------------

SPECIFICATION = {
    "domain": {"width": "25 mm", "height": "0.2 m"},
    "shapes": {
        "choice": "form_distribution",
        "flatness": {"mean": 0.6, "std": 0.1},
        "elongation": {"mean": 1, "std": 0},
    },
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 40},
}
CORNERS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, -1.0, -1.0]])
FACES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
BASE = Base("pebble", CORNERS, FACES, 2.0 / 3.0, np.array([0.1, 0.2, 0.3]))


def leaves(tree, path=()):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key), value


def changed(tree, path):
    """Return the tree with another value at the path; a float changes by the smallest possible amount."""
    tree = copy.deepcopy(tree)
    group = tree
    for key in path[:-1]:
        group = group[key]
    value = group[path[-1]]
    group[path[-1]] = np.nextafter(value, np.inf).item() if isinstance(value, float) else [value, "other"]
    return tree


def test_every_key_of_a_specification_counts_but_for_those_that_change_no_bits():
    resolved = resolve(SPECIFICATION)
    key = scene_key(resolved, [BASE])
    paths = [path for path, _ in leaves(resolved)]
    without = {path for path in paths if scene_key(changed(resolved, path), [BASE]) == key}
    assert without == {
        ("name",),
        ("accuracy",),
        ("numerics", "progress_interval"),
        ("sizes", "allow_few_top_grains"),
        ("damping", "max_time"),
    }
    assert len(key) == 16 and int(key, 16) >= 0
    # The schema must contain each of them: if a key were renamed there, it would count.
    for *groups, last in without:
        schema = read_schema("packing")
        for group in groups:
            schema = schema["properties"][group]
        assert last in schema["properties"]


def test_neither_the_order_of_keys_nor_how_arrays_are_held_counts():
    def reversed_keys(tree):
        return {key: reversed_keys(tree[key]) for key in reversed(tree)} if isinstance(tree, dict) else tree

    resolved = resolve(SPECIFICATION)
    turned = reversed_keys(resolved)
    assert list(turned) != list(resolved)
    same = BASE._replace(
        vertices=np.asfortranarray(CORNERS), faces=FACES.astype(np.int32), volume=np.float64(2.0 / 3.0)
    )
    assert scene_key(turned, iter([same])) == scene_key(resolved, [BASE])


def test_the_content_of_the_base_shapes_and_of_what_is_drawn_counts():
    resolved, nudged = resolve(SPECIFICATION), CORNERS.copy()
    nudged[3, 2] = np.nextafter(-1.0, 0.0)
    others = [BASE._replace(name="cobble"), BASE._replace(volume=0.6), BASE._replace(faces=FACES[::-1])]
    others += [BASE._replace(vertices=nudged), BASE._replace(second_moments=np.array([0.1, 0.2, 0.4]))]
    sets = [[], [BASE], [BASE, BASE], *([other] for other in others), [BASE, others[0]], [others[0], BASE]]
    drawn = [(), (np.arange(3),), (np.arange(3.0),), (np.arange(4),), (np.arange(3).reshape(3, 1),)]
    keys = [scene_key(resolved, bases) for bases in sets] + [scene_key(resolved, [BASE], some) for some in drawn[1:]]
    assert len(set(keys)) == len(sets) + len(drawn) - 1
