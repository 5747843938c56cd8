"""Drawing side by side: the same results, and the second process's faults told."""

import multiprocessing
import os
import time

import pytest
from bladeroot.report.contents import _side_by_side


@pytest.mark.parametrize("processes", [1, 2])
def test_results_come_in_the_order_of_the_tasks(processes):
    assert _side_by_side([abs, str, float, bool], -3, processes) == [3, "-3", -3.0, True]


@pytest.mark.parametrize("tasks", [[str, int], [int, str]])
def test_a_fault_on_either_side_is_the_fault_of_all(tasks):
    with pytest.raises(ValueError, match="invalid literal"):
        _side_by_side(tasks, "no number", 2)


def test_the_process_that_is_free_takes_the_next():
    done = multiprocessing.get_context("fork").Event()
    tasks = [lambda _: done.wait(20.0), lambda _: done.set(), str, str]
    assert _side_by_side(tasks, 3, 2) == [True, None, "3", "3"]


def test_a_second_process_that_is_ended_is_told():
    parent = os.getpid()

    def task(_):
        if os.getpid() != parent:
            os._exit(9)
        while multiprocessing.active_children():  # until the other has taken one, too
            time.sleep(0.01)

    with pytest.raises(RuntimeError, match="was ended"):
        _side_by_side([task, task], None, 2)
