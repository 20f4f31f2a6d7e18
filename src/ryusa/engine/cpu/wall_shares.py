"""Contacts of a grain with planes and faces whose normals are near to each other share a force (0019)."""
# ruff: noqa: E741  (l is a lane)

from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import faces as F
from ryusa.engine.cpu.arrays import CandidateArrays
from ryusa.engine.shared.contact_instants import NOTHING, TOUCHES
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.model.walls import CELLS, DOUBLINGS, EXACT_SHARE, LEAST_SHARE, LIKE_MOST, SWEEPS

LEAST_OVERLAP = 1e-9  # of the radius


@inner(fastmath=FAST, forceinline=True)
def before(q: int, s: int, n_plane: int, face: Any, met: Any) -> bool:
    """Whether row q comes before row s: the nearer; of two as near a face before a plane, then in order."""
    if met[q, F.DISTANCE] != met[s, F.DISTANCE]:
        return met[q, F.DISTANCE] < met[s, F.DISTANCE]
    if (face[q] < n_plane) != (face[s] < n_plane):
        return face[s] < n_plane
    return q < s


@inner(fastmath=FAST, forceinline=True)
def _alike_by(k: int, g: int, n_plane: int, face: Any, met: Any) -> float:
    """How far the contacts in two rows are one, by the angle between their normals: 1/3 at 15 deg."""
    if face[k] < n_plane and face[g] < n_plane:
        return 0.0  # planes are as in scenes without walls
    a = F.AWAY
    along = met[k, a] * met[g, a] + met[k, a + 1] * met[g, a + 1] + met[k, a + 2] * met[g, a + 2]
    one = max(0.5 + 0.5 * along, 0.0)
    for _ in range(DOUBLINGS):
        one *= one
    return LIKE_MOST * one


@inner(fastmath=FAST, forceinline=True)
def _direction(s: int, met: Any) -> int:
    """Number of the cell of directions that the normal in a row belongs to, about 6 deg wide."""
    cell = 0
    for k in range(3):
        cell = cell * 64 + int((met[s, F.AWAY + k] + 1.5) * CELLS)
    return cell


@inner(fastmath=FAST, forceinline=False)
def deepest_of_directions(begin: int, stop: int, r: float, n_plane: int, face: Any, met: Any) -> int:
    """Keep the deepest of the contacts whose normals belong to one cell of directions; how many are left."""
    left = 0
    for s in range(begin, stop):
        if met[s, F.BY] != -1.0 or met[s, F.DISTANCE] >= r:
            continue
        cell, by = _direction(s, met), -1
        for q in range(begin, s):
            if met[q, F.BY] == -1.0 and met[q, F.DISTANCE] < r and _direction(q, met) == cell:
                by = q
                break
        if by < 0:
            left += 1
        elif before(by, s, n_plane, face, met):
            met[s, F.BY] = by
        else:
            met[by, F.BY] = s
    return left


@inner(fastmath=FAST, forceinline=False)
def share_forces(
    begin: int, stop: int, r: float, n_plane: int, face: Any, number: Any, touching: Any, met: Any
) -> None:
    """Write minus the share of its force that each contact of a grain has into its place in BY (design/0019).

    With overlaps d and K the matrix of `_alike_by` the forces over k_n are the f >= 0 that make f.d - f.K.f/2
    largest, by sweeps one after the other; a share is f over d.
    """
    if deepest_of_directions(begin, stop, r, n_plane, face, met) == 0:
        return
    count, largest = 0, 0.0
    for s in range(begin, stop):  # a contact with exact timing may act although it has no overlap any more
        if met[s, F.BY] == -1.0 and (met[s, F.DISTANCE] < r or touching[number[s]]):
            overlap = max(r - met[s, F.DISTANCE], LEAST_OVERLAP * r)
            met[s, F.OVERLAP], met[s, F.FORCE] = overlap, overlap
            count, largest = count + 1, max(largest, overlap)
        else:
            met[s, F.OVERLAP] = met[s, F.FORCE] = 0.0
    if count < 2:
        return
    for s in range(begin, stop):
        if met[s, F.OVERLAP] > 0.0:
            total = 1.0
            for q in range(begin, stop):
                if q != s and met[q, F.OVERLAP] > 0.0:
                    total += _alike_by(s, q, n_plane, face, met)
            met[s, F.FORCE] = met[s, F.OVERLAP] / total
    for _ in range(max(SWEEPS // count, 20)):
        change = 0.0
        for s in range(begin, stop):
            if met[s, F.OVERLAP] == 0.0:
                continue
            force = met[s, F.OVERLAP]
            for q in range(begin, stop):
                if q != s and met[q, F.FORCE] > 0.0:
                    force -= _alike_by(s, q, n_plane, face, met) * met[q, F.FORCE]
            force = max(force, 0.0)
            change = max(change, abs(force - met[s, F.FORCE]))
            met[s, F.FORCE] = force
        if change <= EXACT_SHARE * largest:
            break
    for s in range(begin, stop):
        if met[s, F.OVERLAP] > 0.0:
            met[s, F.BY] = -max(met[s, F.FORCE] / met[s, F.OVERLAP], LEAST_SHARE)


@inner(fastmath=FAST)
def leave_to_shares(
    b: int, face_lanes: Any, selected: Any, candidates: CandidateArrays, met: Any, batch: Any
) -> None:  # fmt: skip
    """Let only the first of faces that share a force be touched ahead, and none beside one in touch.

    The share of the others is not known before they have an overlap: they begin at the next kick, by their
    place. Each with its whole force, facets of a tip that are met at once stopped a grain many times over.
    """
    first, slot, count = candidates.first[b], candidates.slot, candidates.face_count[b]
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        k = selected[l]
        if batch[B.KIND + l] != TOUCHES or candidates.touching[k]:
            continue
        s = slot[k]
        begin = s
        while begin > 0 and candidates.face_grain[first + begin - 1] == candidates.i[k]:
            begin -= 1
        q = begin
        while q < count and candidates.face_grain[first + q] == candidates.i[k]:
            if _like(s, q, met) and (
                candidates.touching[candidates.face[first + q]] or _is_met_before(q, s, l, met, batch)
            ):
                batch[B.KIND + l] = NOTHING
            q += 1


@inner(fastmath=FAST, forceinline=True)
def _is_met_before(q: int, s: int, l: int, met: Any, batch: Any) -> bool:
    """Whether a grain meets the face in row q before that in row s, on lane l, as it moves now."""
    if met[q, F.BY] >= 0.0 or met[q, F.GAP] == B.FAR:
        return False
    closing = 0.0
    for a in range(3):
        closing -= batch[B.RELATIVE_VELOCITY + 4 * l + a] * met[q, F.AWAY + a]
    ahead = (met[q, F.DISTANCE] - met[s, F.DISTANCE] - batch[B.OVERLAP + l]) * batch[B.CLOSING + l]
    own = -batch[B.OVERLAP + l] * closing
    return closing > 0.0 and (ahead < own or (ahead == own and q < s))


@inner(fastmath=FAST, forceinline=True)
def _like(k: int, g: int, met: Any) -> bool:
    """Whether the normals in two rows, not both of planes, are less than 60 deg apart."""
    a = F.AWAY
    along = met[k, a] * met[g, a] + met[k, a + 1] * met[g, a + 1] + met[k, a + 2] * met[g, a + 2]
    return k != g and along > 0.5 and (met[k, F.SLOT] >= 0.0 or met[g, F.SLOT] >= 0.0)


@inner(fastmath=FAST, forceinline=True)
def account_of_shares(face_lanes: Any, selected: Any, slot: Any, met: Any, batch: Any) -> None:
    """Keep the account of the faces in a batch that have a share of their force, and write the shares."""
    for l in range(B.LANES):
        batch[B.SHARE + l] = 1.0
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        share = -met[slot[selected[l]], F.BY]
        if 0.0 < share < 1.0:
            batch[B.SHARE + l] = share
            for k in range(B.N_WORK):
                batch[B.KEPT + k * B.PITCH + l] = batch[B.WORK + k * B.PITCH + l]


@inner(fastmath=FAST, forceinline=True)
def take_shares(face_lanes: Any, batch: Any) -> None:
    """Reduce forces, torques and work of the faces in a batch to their shares."""
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        share = batch[B.SHARE + l]
        if share == 1.0:
            continue
        for k in range(B.N_WORK):
            before = batch[B.KEPT + k * B.PITCH + l]
            at = B.WORK + k * B.PITCH + l
            batch[at] = before + share * (batch[at] - before)
        for k in range(3):
            batch[B.FORCE + 4 * l + k] *= share
            batch[B.TORQUE_I + 4 * l + k] *= share
            batch[B.TORQUE_J + 4 * l + k] *= share
            batch[B.SIDEWAYS + 4 * l + k] *= share  # with exact timing


@inner(fastmath=FAST, forceinline=True)
def share_of(k: int, n_solid: int, candidates: CandidateArrays, met: Any) -> float:
    """Share of its force that candidate k has, in a scene with walls."""
    if candidates.j[k] < n_solid:
        return 1.0
    by = met[candidates.slot[k], F.BY]
    return min(-by, 1.0) if by < 0.0 else 1.0
