"""Two operators clamp unlike each other."""

ID, UNIT, OUTSIDE = "operator-groups", "difference of ln k", True
SIZES, SIGNED = (0.15, 0.6), True
KIN = ("group-effect", "operator-group", "group")
FORMS = {"both": lambda r: {}, "kt-alone": lambda r: {}, "force": lambda r: {}}


def stick(effect, sheet):
    """Contact or force of one group differs."""
    step = effect.size * sheet.group
    if effect.form == "force":
        return {"force": 0.4 * step * sheet.state["force"]}
    return {"ln_kt": step} if effect.form == "kt-alone" else {"ln_kn": step, "ln_kt": step}
