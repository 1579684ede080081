import pytest

from anisogran.outcome import InputError, NotConverged, RunFailed, Status, checked


def test_checked_names_place_key_value_and_bound():
    assert checked("Luding", "k1", 5, above=0) == 5.0
    with pytest.raises(InputError, match=r"Luding: k1 = -5 must be above 0 N/m"):
        checked("Luding", "k1", -5, above=0, unit="N/m")
    with pytest.raises(InputError, match=r"k1 = 'abc' is not a number"):
        checked("Luding", "k1", "abc")
    for bad in (float("nan"), float("inf")):
        with pytest.raises(InputError, match="must be a finite number"):
            checked("Luding", "k1", bad)
    with pytest.raises(InputError, match="must be at most 1"):
        checked("Friction", "mu", 2, at_most=1)
    assert checked("Friction", "mu", 1, at_least=1, at_most=1) == 1.0
    for bound, words in ({"above": 1}, "above 1"), ({"below": 1}, "below 1"):
        with pytest.raises(InputError, match=f"mu = 1 must be {words}"):
            checked("Friction", "mu", 1, **bound)


def test_status_gets_worse_only():
    status = Status().warn("a")
    assert (status.level, bool(status), str(status)) == ("warned", True, "warned: a")
    failed = status.fail("b").warn("c")
    assert (failed.level, bool(failed), failed.reasons) == ("failed", False, ("a", "b", "c"))
    Status().require()
    with pytest.raises(RunFailed, match="a; b; c"):
        failed.require()


def test_not_converged_carries_history_and_best():
    error = NotConverged("stagnation", [1.0, 0.9], best="iterate")
    assert (str(error), error.history, error.best) == ("stagnation", [1.0, 0.9], "iterate")
