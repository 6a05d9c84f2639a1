# What Xpulp shares with a standard extension is compiled for it: minimum, maximum, sign and zero
# extension, population count. The analysis finds what else Xpulp spares (xpulp.h).
MARCH := rv32imfc_zbb
# Packed integers are an instruction each.
stand_ins := -I target_xpulp
