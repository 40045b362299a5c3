"""The ranks of one packing, under a watchdog that stands outside MPI.

A rank that stops answering stops all others inside MPI, where nothing can end them. So the process here does no MPI: it
starts mpiexec (one rank needs none), looks at the time of a file that rank 0 touches (heartbeat.py), and when that has
been silent for too long ends every process of the run. It finds them by a mark in their environment, since
hydra, the mpiexec of MPICH, gives each rank a session of its own.

What hydra itself does (5.0, on one machine; tests/packing/test_launch.py): a rank that is killed ends all others at
once, SIGTERM is passed to all ranks, and when mpiexec is killed its ranks are too, stopped ones as well. On Linux the
kernel kills mpiexec when this process dies; elsewhere a SIGKILL of this process leaves the ranks running.
"""

import ctypes
import os
import secrets
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil

from simcore.packing.checkpoints.lock import take_lock
from simcore.packing.heartbeat import VARIABLE
from simcore.scene.quantity import parse_quantity

MARK = "SCREE_LAUNCH"  # environment variable that all processes of a run share
INTERRUPTED = 75  # EX_TEMPFAIL: run it again, and it goes on
INTERRUPTIONS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
POLL = 0.2  # [s]
LONGEST_WAIT = 60.0  # [s] for another run of the same output, which may be writing its last checkpoint
PR_SET_PDEATHSIG = 1


def launch(
    command: list[str],
    output: Path,
    *,
    ranks: int = 1,
    threads: int = 1,
    mpiexec: list[str] | None = None,
    silence: float = 600.0,
    startup: float = 1800.0,
    grace: float = 10.0,
    with_parent: bool = False,
    go_on: str = "run the same command again",
) -> int:
    """Exit status of `command` on so many ranks; 1 with one line on stderr where it was killed or fell silent.

    output: the file it writes; beside it stands the heartbeat, `OUTPUT.heartbeat`, which is locked, so that no two runs
    write one file. mpiexec: words of the program that starts ranks, `-n RANKS` is added; by default that of this
    environment. silence [s]: longest time between two heartbeats, startup [s]: until the first, since compiling comes
    before it. grace [s]: between SIGTERM and SIGKILL. with_parent: end as on SIGTERM when the process that started this
    one has ended. go_on: what to do after a kill, in words. SIGTERM, SIGINT and SIGHUP reach all ranks as SIGTERM; the
    status is then 75 unless they had finished; afterwards this process, which has nothing else to do, ignores them.
    ValueError where no mpiexec is found or another run writes `output`.
    """
    words = _with_mpiexec(command, ranks, mpiexec)
    # An interruption while this waits for the lock counts too.
    received = []
    for number in INTERRUPTIONS:
        signal.signal(number, lambda number, frame: received.append(number))
    parent = os.getppid()
    token = secrets.token_hex(8)
    heartbeat = output.with_name(output.name + ".heartbeat")
    lock = _claim(heartbeat, output, received)
    try:
        environment = {**os.environ, MARK: token, VARIABLE: str(heartbeat.resolve())}
        environment["SRUN_CPUS_PER_TASK"] = str(threads)  # srun takes the threads of a rank from nowhere else
        child = _start(words, environment)
        try:
            silent = _watch(child, heartbeat, silence, startup, received, parent if with_parent else None)
        finally:
            # Where the ranks ended by themselves there is nothing left to kill.
            _end(token, child, grace if child.poll() is None else 0.0)
        heartbeat.unlink(missing_ok=True)
    finally:
        lock.close()
        # What comes now is too late, and must not hide how the run ended.
        for number in INTERRUPTIONS:
            signal.signal(number, signal.SIG_IGN)
    if silent:
        _say(f"{output}: {silent}; all its processes were ended; {go_on}")
        return 1
    return _judge(child.returncode, output, received, go_on)


def add_launch_options(parser) -> None:
    """Options of `python -m simcore launch`, for `launch_packing`."""
    parser.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    parser.add_argument("output", type=Path, help="netCDF file to write")
    parser.add_argument("--ranks", type=int, default=1, help="MPI processes; the result does not depend on them")
    parser.add_argument("--threads", type=int, default=1, help="threads of each; the result does not depend on them")
    parser.add_argument("--checkpoints", type=Path, metavar="FOLDER", help="as of pack")
    parser.add_argument("--checkpoint-interval", metavar="TIME", help="as of pack")
    parser.add_argument("--log", type=Path, help="as of pack")
    parser.add_argument("--force", action="store_true", help="as of pack")
    parser.add_argument("--silence", default="10 min", help="longest time without a sign of life, then all is ended")
    parser.add_argument("--startup", default="30 min", help="the same until the first, which compiling comes before")
    parser.add_argument("--grace", default="10 s", help="time between SIGTERM and SIGKILL then")
    parser.add_argument("--mpiexec", default="", help='what starts the ranks, such as "srun"; "-n RANKS" is added')
    parser.add_argument("--with-parent", action="store_true", help="end when what started this has ended")


def launch_packing(options, program: list[str]) -> int:
    """Exit status of `program` pack, run as the options of `add_launch_options` say; see `launch`."""
    times = {}
    for name in ("silence", "startup", "grace"):
        try:
            times[name] = parse_quantity(getattr(options, name), "s")
        except ValueError as error:
            raise ValueError(f"--{name}: {error}") from None
    command = [*program, "pack", str(options.specification), str(options.output), "--threads", str(options.threads)]
    for name in ("checkpoints", "checkpoint_interval", "log"):
        if getattr(options, name) is not None:
            command += [f"--{name.replace('_', '-')}", str(getattr(options, name))]
    if options.force:
        command.append("--force")
    kept = "goes on from its last checkpoint" if options.checkpoints else "starts anew, as it has no --checkpoints"
    return launch(
        command,
        options.output,
        ranks=options.ranks,
        threads=options.threads,
        mpiexec=shlex.split(options.mpiexec) or None,
        with_parent=options.with_parent,
        go_on=f"run the same command again: it {kept}",
        **times,
    )


def _with_mpiexec(command, ranks, mpiexec):
    if ranks < 1:
        raise ValueError(f"ranks: {ranks} asked for; give 1 or more")
    if ranks == 1:
        return command
    if mpiexec is None:
        own = Path(sys.executable).with_name("mpiexec")
        if not own.is_file():
            raise ValueError(
                f"ranks: {ranks} asked for, but there is no {own}; install the package mpich, give --mpiexec, or ask "
                "for one rank"
            )
        mpiexec = [str(own)]
    return [*mpiexec, "-n", str(ranks), *command]


def _claim(heartbeat, output, received):
    """The heartbeat file, locked until it is closed, and not inherited by any rank."""
    waited = None

    def busy(other):
        nonlocal waited
        if waited is None:
            waited = time.monotonic()
            _say(f"{output}: waiting for another run of it to end (process {other})")
        if time.monotonic() - waited > LONGEST_WAIT or received:
            raise ValueError(
                f"{output} is being written by another run (process {other}); wait for it, end it, or give another path"
            )
        time.sleep(POLL)

    file, _ = take_lock(heartbeat, str(os.getpid()), busy)
    return file


def _start(words, environment):
    launcher = os.getpid()
    libc = ctypes.CDLL(None) if sys.platform == "linux" else None

    def die_with_launcher():
        if libc is not None:
            libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != launcher:
                os._exit(1)

    try:
        return subprocess.Popen(
            words, env=environment, stdin=subprocess.DEVNULL, start_new_session=True, preexec_fn=die_with_launcher
        )
    except OSError as error:
        raise OSError(f"{words[0]} cannot be started ({error.strerror}); give another --mpiexec") from None


def _watch(child, heartbeat, silence, startup, received, parent):
    """Wait for the child to end; returns what was wrong, in words, as soon as it is silent for too long.

    Only time in which this process ran counts as silence: after the whole machine slept, ranks get their time again.
    """
    passed_on = 0
    begun, quiet, last = False, 0.0, time.monotonic()
    seen = _time_of(heartbeat)
    while True:
        try:
            child.wait(POLL)
            return ""
        except subprocess.TimeoutExpired:
            pass
        if parent is not None and os.getppid() != parent:
            parent = None
            received.append(signal.SIGTERM)
            _say("the process that started this one has ended: interrupting the packing")
        if len(received) > passed_on:
            passed_on = len(received)
            child.send_signal(signal.SIGTERM)
        now, touched = time.monotonic(), _time_of(heartbeat)
        quiet += min(now - last, 5.0 * POLL)
        last = now
        if touched != seen:
            seen, begun, quiet = touched, True, 0.0
        elif begun and quiet > silence:
            return f"no sign of life for {quiet:.0f} s, {silence:g} s are allowed ({heartbeat})"
        elif not begun and quiet > startup:
            return (
                f"no first sign of life after {quiet:.0f} s, {startup:g} s are allowed ({heartbeat}; where compiling "
                "takes longer, raise --startup)"
            )


def _time_of(heartbeat):
    try:
        return os.stat(heartbeat).st_mtime_ns
    except OSError:
        return None


def _end(token, child, grace):
    """End all processes of the run on this machine: SIGTERM, so many seconds of grace, SIGKILL until none is left."""
    if grace > 0.0:
        _signal_all(token, signal.SIGTERM)
        deadline = time.monotonic() + grace
        while time.monotonic() < deadline and (child.poll() is None or _marked(token)):
            time.sleep(POLL)
    while found := _signal_all(token, signal.SIGKILL):
        psutil.wait_procs(found, timeout=1.0)
    if child.poll() is None:
        child.kill()
        child.wait()


def _signal_all(token, number):
    found = _marked(token)
    for process in found:
        try:
            process.send_signal(number)
        except psutil.NoSuchProcess:
            pass
    return found


def _marked(token):
    """Processes of the run that are alive; a zombie has no environment any more."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == token:
                found.append(process)
        except (psutil.Error, OSError):
            pass
    return found


def _judge(status, output, received, go_on):
    if status in (0, 1, 2, INTERRUPTED):  # the packing has said why
        return status
    if received:  # before it could write a checkpoint
        _say(f"{output}: interrupted ({signal.Signals(received[0]).name}); {go_on}")
        return INTERRUPTED
    _say(f"{output}: {_cause(status)}; {go_on}")
    return 1


def _cause(status):
    """What ended the ranks: Popen tells a signal as -n, mpiexec as n or 128 + n; a packing ends with 0, 1, 2 or 75."""
    number = -status if status < 0 else status - 128 if status > 128 else status
    try:
        name = signal.Signals(number).name
    except ValueError:
        return f"the ranks ended with status {status}"
    why = " (by hand, or for want of memory)" if number == signal.SIGKILL else ""
    return f"a rank was ended by {name}{why}"


def _say(line):
    print(f"simcore launch: {line}", file=sys.stderr, flush=True)
