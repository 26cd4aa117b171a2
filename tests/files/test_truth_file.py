"""The truth comes back as it was sealed, complex shapes and residues included."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from vgvt.data import Dof, InputError, ModalModel, Outcome, RigidBodyProperties, Truth
from vgvt.files.truth import content_hash, read_truth, write_truth


def model(modes: int, seed: int, **more: object) -> ModalModel:
    """A modal model of random numbers at three DOFs."""
    generator = np.random.default_rng(seed)
    shape = generator.standard_normal((2, modes, 3))
    return ModalModel(
        natural_frequency_hz=np.sort(generator.uniform(1, 40, modes)),
        damping_ratio=generator.uniform(0.001, 0.03, modes),
        shapes=shape[0] + 1j * shape[1],
        dofs=tuple(Dof.from_label(x) for x in ("1+Z", "2-X", "3+RY")),
        **more,
    )


@pytest.fixture
def truth() -> Truth:
    """A truth with every field in use somewhere, and a model without modes."""
    rich = model(
        4,
        2,
        natural_frequency_std_hz=np.array([0.1, np.nan, 0.2, 0.3]),
        damping_ratio_std=np.full(4, np.nan),
        modal_mass_kg=np.arange(1.0, 5.0),
        references=(Dof.from_label("100+Z"),),
        residues=np.random.default_rng(3).standard_normal((4, 3, 1)) * (1 + 2j),
        labels=("heave", "1st symmetric bending", "", "torsion"),
        flags=(("rigid",), (), ("close to ½", "b"), ()),
        method="linearised",
        advice=("a", "b"),
        settings={"engine": "linear"},
    )
    body = RigidBodyProperties(6.2, np.array([0.6, 0.0, 0.01]), np.diag([2.8, 0.5, 2.9]))
    empty = ModalModel.empty(Outcome.NOTHING_FOUND, ("nothing here",), "none", rich.dofs)
    return Truth("quick", body, model(3, 1), (1, 5), (rich, model(2, 4)), (empty, model(1, 5)))


def assert_same(first: object, second: object) -> None:
    """Equal field by field, arrays bit for bit and of the same type."""
    for field in fields(first):  # type: ignore[arg-type]
        one, other = getattr(first, field.name), getattr(second, field.name)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype
            np.testing.assert_array_equal(one, other, strict=True)
        else:
            assert one == other, field.name


def test_the_truth_comes_back_as_it_was(truth: Truth, tmp_path: Path) -> None:
    path = tmp_path / "sealed" / "truth.nc"
    write_truth(path, truth)
    back = read_truth(path)
    assert (back.scenario, back.runs) == (truth.scenario, truth.runs)
    assert_same(truth.rigid_body, back.rigid_body)
    for one, other in zip(
        (truth.bare, *truth.as_tested, *truth.coupled), (back.bare, *back.as_tested, *back.coupled), strict=True
    ):
        assert_same(one, other)


def test_damage_is_told(truth: Truth, tmp_path: Path) -> None:
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    with h5py.File(path, "r+") as file:
        del file["as_tested_5/shapes"]
    with pytest.raises(InputError, match="as_tested_5: 'shapes' is missing"):
        read_truth(path)
    write_truth(path, truth)
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match="damaged"):
        read_truth(path)


def test_a_sensor_that_was_turned_on_disk_is_recognised(truth: Truth, tmp_path: Path) -> None:
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    whole = path.read_bytes()[:-48]  # without its seal, as up to version 0.1
    assert b'"1+Z"' in whole
    path.write_bytes(whole.replace(b'"1+Z"', b'"1-Z"'))
    with pytest.raises(InputError, match="does not match its SHA-256"):
        read_truth(path)


def test_the_hash_depends_on_everything_that_a_truth_says(truth: Truth) -> None:
    rich, body = truth.as_tested[0], truth.rigid_body
    models = [
        replace(rich, **{name: np.nextafter(getattr(rich, name).real, 99.0) + 0 * getattr(rich, name)})
        for name in ("damping_ratio", "shapes", "natural_frequency_std_hz", "modal_mass_kg", "residues")
    ]
    models += [replace(rich, dofs=rich.dofs[::-1]), replace(rich, references=(Dof.from_label("100-Z"),))]
    models += [replace(rich, labels=("",) * 4), replace(rich, flags=((),) * 4), replace(rich, method="", advice=("b",))]
    models += [replace(rich, settings={"engine": "mujoco"}), replace(rich, modal_mass_kg=None)]
    models += [replace(rich, output_only=True)]
    changed = [replace(truth, as_tested=(model, truth.as_tested[1])) for model in models]
    changed += [replace(truth, scenario="other"), replace(truth, runs=(1, 4)), replace(truth, bare=rich)]
    changed += [
        replace(truth, rigid_body=replace(body, mass_kg=6.3)),
        replace(truth, rigid_body=replace(body, inertia_kg_m2=2 * body.inertia_kg_m2)),
        replace(truth, rigid_body=replace(body, centre_of_gravity_m=np.zeros(3))),
    ]
    assert len({content_hash(t) for t in (truth, *changed)}) == len(changed) + 1
    assert content_hash(replace(truth)) == content_hash(truth)


def test_files_from_before_truths_had_hashes_are_read(truth: Truth, tmp_path: Path) -> None:
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    with h5py.File(path, "r+") as file:
        del file.attrs["content_sha256"]
    with pytest.raises(InputError, match="'content_sha256' is missing"):
        read_truth(path)
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 1
    assert content_hash(read_truth(path)) == content_hash(truth)


def test_files_from_before_a_claim_could_be_without_the_force_are_read(truth: Truth, tmp_path: Path) -> None:
    """That word is in no hash where it is not said, and means no where it is missing."""
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    with h5py.File(path, "r+") as file:
        for run in truth.runs:
            del file[f"as_tested_{run}"].attrs["output_only"]
            del file[f"coupled_{run}"].attrs["output_only"]
        del file["bare"].attrs["output_only"]
        file.attrs["format_version"] = 2
    assert content_hash(read_truth(path)) == content_hash(truth)


def test_a_claim_without_the_force_comes_back_as_one(truth: Truth, tmp_path: Path) -> None:
    path = tmp_path / "truth.nc"
    write_truth(path, replace(truth, bare=replace(truth.bare, output_only=True)))
    back = read_truth(path)
    assert (back.bare.output_only, back.as_tested[0].output_only) == (True, False)


@pytest.mark.parametrize("name", ["dofs", "flags", "settings", "labels"])
def test_words_of_the_wrong_kind_are_damage(truth: Truth, tmp_path: Path, name: str) -> None:
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    with h5py.File(path, "r+") as file:
        file["bare"].attrs[name] = "[[3]]"
    with pytest.raises(InputError, match=r"damaged|SHA-256"):
        read_truth(path)


def test_a_damaged_dimension_is_damage(truth: Truth, tmp_path: Path) -> None:
    """h5py then finds an object without a name."""
    path = tmp_path / "truth.nc"
    write_truth(path, truth)
    whole = path.read_bytes()
    places = [match.start() for match in re.finditer(b"This is a netCDF dimension", whole)]
    assert len(places) > 5
    for at in places:
        path.write_bytes(whole[:at] + b"t" + whole[at + 1 :])
        with pytest.raises(InputError, match="damaged"):
            read_truth(path)


def test_a_campaign_is_no_truth(campaign, tmp_path: Path) -> None:
    from vgvt.files import write_campaign

    write_campaign(tmp_path / "c.nc", campaign)
    with pytest.raises(InputError, match="'vgvt campaign', not 'vgvt truth'"):
        read_truth(tmp_path / "c.nc")


def test_a_truth_is_no_campaign(truth: Truth, tmp_path: Path) -> None:
    from vgvt.files import read_campaign

    write_truth(tmp_path / "t.nc", replace(truth, scenario="other"))
    with pytest.raises(InputError, match="'vgvt truth', not 'vgvt campaign'"):
        read_campaign(tmp_path / "t.nc")


def test_the_files_package_does_not_hand_out_the_truth() -> None:
    import vgvt.files

    assert not [name for name in dir(vgvt.files) if name.endswith("_truth")]
