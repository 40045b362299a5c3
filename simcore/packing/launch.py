"""Run the ranks of one packing under a watchdog that does not use MPI.

If one rank hangs, all others hang inside MPI, where nothing can end them. The process here therefore does not use MPI:
it starts mpiexec (a single rank needs none), watches the modification time of a file that rank 0 touches
(heartbeat.py), and ends every process of the run if the file has not been touched for too long. It finds these
processes by a mark in their environment, since hydra, the mpiexec of MPICH, starts each rank in its own session.

Hydra 5.0 on one machine behaves as follows (tests/packing/test_launch.py): if a rank is killed, hydra ends all others
at once; SIGTERM is passed to all ranks; and if mpiexec is killed, its ranks are killed too, also stopped ones. On Linux
the kernel kills mpiexec when this process dies; on other systems a SIGKILL of this process leaves the ranks running.
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
INTERRUPTED = 75  # EX_TEMPFAIL: the same command resumes the packing
INTERRUPTIONS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
POLL = 0.2  # [s]
LONGEST_WAIT = 60.0  # [s], for another run of the same output, which may be writing its last checkpoint
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
    """Run `command` on this number of ranks and return its exit status.

    If the command was killed or its heartbeat stopped, the status is 1 and one line on stderr gives the reason.

    output: the file that the command writes. The heartbeat file `OUTPUT.heartbeat` beside it is locked, so that no two
    runs write the same output. mpiexec: words of the program that starts ranks, to which `-n RANKS` is added; by
    default the mpiexec of this environment. silence [s]: longest time between two heartbeats. startup [s]: longest time
    until the first heartbeat, which comes after compiling. grace [s]: time between SIGTERM and SIGKILL. with_parent:
    end as on SIGTERM if the parent process has ended. go_on: what the user should do after a kill, in words.

    SIGTERM, SIGINT and SIGHUP are passed to all ranks as SIGTERM; the status is then 75 unless the ranks had finished.
    After the run this process ignores these signals. ValueError if `ranks` is below 1, if mpiexec is missing, or if
    another run writes `output`; OSError if the program cannot be started.
    """
    words = _with_mpiexec(command, ranks, mpiexec)
    # Handlers come before the lock, so that an interruption during the wait for it counts too.
    received = []
    for number in INTERRUPTIONS:
        signal.signal(number, lambda number, frame: received.append(number))
    parent = os.getppid()
    token = secrets.token_hex(8)
    heartbeat = output.with_name(output.name + ".heartbeat")
    lock = _claim(heartbeat, output, received)
    try:
        environment = {**os.environ, MARK: token, VARIABLE: str(heartbeat.resolve())}
        environment["SRUN_CPUS_PER_TASK"] = str(threads)  # srun reads the threads of a rank only from here
        child = _start(words, environment)
        try:
            silent = _watch(child, heartbeat, silence, startup, received, parent if with_parent else None)
        finally:
            # If the ranks ended by themselves, no grace is needed.
            _end(token, child, grace if child.poll() is None else 0.0)
        heartbeat.unlink(missing_ok=True)
    finally:
        lock.close()
        # A signal from now on comes too late and must not hide how the run ended.
        for number in INTERRUPTIONS:
            signal.signal(number, signal.SIG_IGN)
    if silent:
        _report(f"{output}: {silent}. All its processes were ended; {go_on}")
        return 1
    return _judge(child.returncode, words != command, output, received, go_on)


def launch_packing(options, program: list[str]) -> int:
    """Run `program` pack with the options of `simcore.commands.launch` and return its exit status; see `launch`."""
    times = {}
    for name in ("silence", "startup", "grace"):
        try:
            times[name] = parse_quantity(getattr(options, name), "s")
        except ValueError as error:
            raise ValueError(f"--{name}: {error}") from None
        if not (times[name] > 0.0 or name == "grace" and times[name] == 0.0):
            raise ValueError(f"--{name}: '{getattr(options, name)}' is not a time above 0; give one such as '10 min'")
    command = [*program, "pack", str(options.specification), str(options.output), "--threads", str(options.threads)]
    for name in ("checkpoints", "checkpoint_interval", "log", "frames", "cut"):
        if getattr(options, name) is not None:
            command += [f"--{name.replace('_', '-')}", str(getattr(options, name))]
    if options.force:
        command.append("--force")
    effect = "resumes from its last checkpoint" if options.checkpoints else "starts again, as it has no --checkpoints"
    return launch(
        command,
        options.output,
        ranks=options.ranks,
        threads=options.threads,
        mpiexec=shlex.split(options.mpiexec) or None,
        with_parent=options.with_parent,
        go_on=f"run the same command again: it {effect}",
        **times,
    )


def _with_mpiexec(command, ranks, mpiexec):
    if ranks < 1:
        raise ValueError(f"ranks: {ranks} is not possible; give 1 or more")
    if ranks == 1:
        return command
    if mpiexec is None:
        own = Path(sys.executable).with_name("mpiexec")
        if not own.is_file():
            raise ValueError(
                f"ranks: {ranks} ranks need mpiexec, but there is no {own}. Install the package mpich, give --mpiexec, "
                "or use one rank."
            )
        mpiexec = [str(own)]
    return [*mpiexec, "-n", str(ranks), *command]


def _claim(heartbeat, output, received):
    """Return the heartbeat file, locked until it is closed; ranks do not inherit it."""
    waiting_since = None

    def busy(other):
        nonlocal waiting_since
        if waiting_since is None:
            waiting_since = time.monotonic()
            _report(f"{output}: waiting for another run that writes it to end (process {other})")
        if time.monotonic() - waiting_since > LONGEST_WAIT or received:
            raise ValueError(
                f"{output} is being written by another run (process {other}). Wait until it ends, end it, or give "
                "another path."
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
        raise OSError(f"{words[0]} cannot be started ({error.strerror}). Give another --mpiexec.") from None


def _watch(child, heartbeat, silence, startup, received, parent):
    """Wait for the child to end and return ""; if heartbeats fail for too long, return a sentence that says so.

    Only time during which this process ran counts: after the whole machine was suspended, the ranks get the full time.
    """
    passed_on = 0
    started, quiet, last = False, 0.0, time.monotonic()
    last_beat = _time_of(heartbeat)
    while True:
        try:
            child.wait(POLL)
            return ""
        except subprocess.TimeoutExpired:
            pass
        if parent is not None and os.getppid() != parent:
            parent = None
            received.append(signal.SIGTERM)
            _report("the parent process has ended; the packing is interrupted")
        if len(received) > passed_on:
            passed_on = len(received)
            child.send_signal(signal.SIGTERM)
        now, touched = time.monotonic(), _time_of(heartbeat)
        quiet += min(now - last, 5.0 * POLL)
        last = now
        if touched != last_beat:
            last_beat, started, quiet = touched, True, 0.0
        elif started and quiet > silence:
            return f"no heartbeat for {quiet:.0f} s, but at most {silence:g} s are allowed ({heartbeat})"
        elif not started and quiet > startup:
            return (
                f"no first heartbeat after {quiet:.0f} s, but at most {startup:g} s are allowed ({heartbeat}; if "
                "compiling takes longer, raise --startup)"
            )


def _time_of(heartbeat):
    try:
        return os.stat(heartbeat).st_mtime_ns
    except OSError:
        return None


def _end(token, child, grace):
    """End all processes of the run on this machine: SIGTERM, then, after `grace` [s], SIGKILL until none is left."""
    if grace > 0.0:
        _signal_all(token, signal.SIGTERM)
        deadline = time.monotonic() + grace
        while time.monotonic() < deadline and (child.poll() is None or _marked(token)):
            time.sleep(POLL)
    while processes := _signal_all(token, signal.SIGKILL):
        psutil.wait_procs(processes, timeout=1.0)
    if child.poll() is None:
        child.kill()
        child.wait()


def _signal_all(token, number):
    processes = _marked(token)
    for process in processes:
        try:
            process.send_signal(number)
        except psutil.NoSuchProcess:
            pass
    return processes


def _marked(token):
    """Return the processes of the run that are alive; a zombie has no environment and is not included."""
    processes = []
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == token:
                processes.append(process)
        except (psutil.Error, OSError):
            pass
    return processes


def _judge(status, by_mpiexec, output, received, go_on):
    if status in (0, 1, 2, INTERRUPTED):  # the packing has reported the reason
        return status
    if received:  # before it could write a checkpoint
        _report(f"{output}: interrupted ({signal.Signals(received[0]).name}); {go_on}")
        return INTERRUPTED
    _report(f"{output}: {_cause(status, by_mpiexec)}; {go_on}")
    return 1


def _cause(status, by_mpiexec):
    """Return what ended the ranks, in words.

    A signal n has status -n from Popen, and n or 128 + n from mpiexec; a packing ends with 0, 1, 2 or 75.
    """
    if status >= 0 and not by_mpiexec:
        return f"the packing ended with status {status}"
    number = -status if status < 0 else status - 128 if status > 128 else status
    try:
        name = signal.Signals(number).name
    except ValueError:
        return f"the ranks ended with status {status}"
    why = " (by hand, or because memory ran out)" if number == signal.SIGKILL else ""
    return f"a rank was ended by {name}{why}"


def _report(line):
    print(f"scree launch: {line}", file=sys.stderr, flush=True)
