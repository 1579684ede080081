"""The error budget of the main job as tables in markdown."""

from dataclasses import replace

from anisogran.cost.budget import KNOBS
from anisogran.cost.main_job import MainJob
from anisogran.cost.tables import row
from anisogran.cost.whole_way import price_of

USUAL = MainJob().knobs(KNOBS)
ACCURACIES = (0.1, 0.05, 0.03, 0.02)


def line(*cells):
    return f"| {' | '.join(cells)} |"


def budget_table(budget, price):
    """A cause a line, an answer a column, the usual values; at the end what the next second is best spent on."""
    parts = {answer: {source.cause: told(budget, source) for source, _ in budget.parts(answer, USUAL)} for answer in budget.names}
    causes = dict.fromkeys(cause for own in parts.values() for cause in own)
    lines = [line("error from", *parts), line(*["---"] * (1 + len(parts)))]
    for cause in causes:
        lines.append(line(cause, *(own.get(cause, "") for own in parts.values())))
    lines.append(line("**all together**", *(f"**{budget.error(answer, USUAL):.2g}**" for answer in parts)))
    lines.append(line("the next second goes to", *(budget.next_second(answer, USUAL, price)[0][0] for answer in parts)))
    return "\n".join(lines)


def told(budget, source):
    """An error and how well it is known, which goes with the knobs as the error does; below its uncertainty, only that it is below."""
    error, uncertainty = (budget.error_of(replace(source, error=one), USUAL) for one in (source.error, source.uncertainty))
    if error < uncertainty:
        return f"< {uncertainty:.1g}"
    return f"{error:.2g} ± {uncertainty:.1g}" if uncertainty > 0.1 * error else f"{error:.1g}"


def choice_table(budget, price):
    """What is chosen for some accuracies, and the processor seconds."""
    lines = [line("accuracy", *KNOBS, "processor seconds"), line(*["---"] * (2 + len(KNOBS)))]
    for accuracy in ACCURACIES:
        choice = budget.choose(accuracy, price)
        lines.append(line(f"{accuracy:g}", *(f"{value:g}" for value in choice.values()), f"{price(choice):.0f}"))
    lines.append(line("the defaults", *(f"{value:g}" for value in USUAL.values()), f"{price(USUAL):.0f}"))
    return "\n".join(lines)


def choice_rows(budget):
    """{answer: rows} of a cost table: its expected error against seconds, as the accuracy that is asked for becomes finer."""
    price = price_of(budget, MainJob())
    choices = {accuracy: budget.choose(accuracy, price) for accuracy in (0.15, 0.07, *ACCURACIES)}
    finer = sorted(choices.items(), reverse=True)
    told = "accuracy of the whole way"
    return {name: [row(told, asked, budget.error(name, choice), price(choice)) for asked, choice in finer] for name in budget.names}


def budget_tables(budget):
    """Text of two tables of a Budget: where the error of the main job comes from, and what is chosen for an accuracy."""
    made, price = budget.made, price_of(budget, MainJob())
    head = f"{made['date']}, {made['machine']}. Relative errors at the defaults, ± how well they are known:"
    between = "The knobs that `anisogran demo --accuracy` chooses, and processor seconds:"
    return "\n\n".join([head, budget_table(budget, price), between, choice_table(budget, price)])
