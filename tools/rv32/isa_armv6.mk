# ARM1176. Its libraries are those for ARMv5TE, the nearest that there are.
target := -mcpu=arm1176jzf-s -marm -mfloat-abi=hard -mfpu=vfp
