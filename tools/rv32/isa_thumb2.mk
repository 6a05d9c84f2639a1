# Cortex-M4F; a Cortex-M7 executes the same code.
target := -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16
