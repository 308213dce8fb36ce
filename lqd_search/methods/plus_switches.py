"""What `ours_plus` may do differently from `ours`, one switch each."""

from collections.abc import Collection
from enum import StrEnum

from lqd_envs import SolutionSpace
from lqd_search.emitters.contact_variation import ContactVariation
from lqd_search.emitters.emitter import Emitter
from lqd_search.emitters.evolution_emitter import EvolutionEmitter
from lqd_search.emitters.mes_emitter import MESEmitter
from lqd_search.emitters.mixed_emitter import MixedEmitter, Part
from lqd_search.emitters.random_emitter import RandomEmitter
from lqd_search.emitters.screen import NeighbourScreen
from lqd_search.emitters.shares import CreditedShares, EvenShares, ManyCellShares, Shares
from lqd_search.emitters.variation import Mutation, SuccessLine, Variation
from lqd_search.evaluation.contact import touched
from lqd_search.methods.method import MethodError

_FINE = SolutionSpace(position_std=0.05, orientation_std=0.1, motion_std=0.05)
_RANDOM_SHARE = 0.05
_EVOLUTION_SHARE = 0.2


class Switch(StrEnum):
    """One way in which the emitter of `ours_plus` may differ from that of `ours`."""

    LINE = "line"
    """Children of successes lie near lines to other successes: `SuccessLine`."""
    RANDOM = "random"
    """5 % of each generation are random solutions: `RandomEmitter`."""
    CREDIT = "credit"
    """Grids get parents by what their children found of late: `CreditedShares`."""
    SCREEN = "screen"
    """Of three candidates the first with a neighbour that touched: `NeighbourScreen`."""
    CONTACT = "contact"
    """A quarter of the children reach their parent's contact from elsewhere: `ContactVariation`."""
    EVOLUTION = "evolution"
    """20 % of each generation come from CMA-ME: `EvolutionEmitter`."""
    MANY_CELLS = "many_cells"
    """Grids with a single cell get no parents: `ManyCellShares`."""


def known_switches(switches: Collection[Switch]) -> frozenset[Switch]:
    """Return switches that were given by their names, perhaps, as what they are.

    Args:
        switches: Switches, or their names.

    Raises:
        MethodError: One has a name that is not known.
    """
    known = list(Switch)
    unknown = [switch for switch in switches if switch not in known]
    if unknown:
        raise MethodError(
            f"Expected switches among {', '.join(known)}, but got "
            f"{', '.join(map(repr, unknown))}; choose from these."
        )
    return frozenset(map(Switch, switches))


def emitter_with(switches: Collection[Switch], *, space: SolutionSpace) -> Emitter:
    """Make the emitter of a search with some of the switches on.

    Args:
        switches: Those that are on; with none it is the emitter of `ours`.
        space: Where solutions come from.

    Returns:
        An emitter that has seen nothing yet. With `SCREEN` it must be told values with the column
        `contact`; with `CONTACT` the archive must store it.

    Raises:
        MethodError: A switch has a name that is not known.
    """
    switches = known_switches(switches)
    main = MESEmitter(
        space,
        shares=_shares(switches),
        variation=_variation(switches, space),
        screen=NeighbourScreen(worth=touched) if Switch.SCREEN in switches else None,
    )
    others = []
    if Switch.RANDOM in switches:
        others.append(Part(RandomEmitter(space), _RANDOM_SHARE))
    if Switch.EVOLUTION in switches:
        others.append(Part(EvolutionEmitter(space), _EVOLUTION_SHARE))
    return MixedEmitter(main, others) if others else main


def _shares(switches: Collection[Switch]) -> Shares:
    shares: Shares = CreditedShares() if Switch.CREDIT in switches else EvenShares()
    return ManyCellShares(shares) if Switch.MANY_CELLS in switches else shares


def _variation(switches: Collection[Switch], space: SolutionSpace) -> Variation:
    variation: Variation = Mutation(space)
    if Switch.LINE in switches:
        variation = SuccessLine(near=_FINE, far=space)
    if Switch.CONTACT in switches:
        variation = ContactVariation(space, otherwise=variation)
    return variation
