"""Compiled arms and torque laws: symbolic dynamics and machine code.

Only this package imports llvmlite. Without llvmlite, or for a control law without a compiled form, runs use the
uncompiled code. Otherwise the config determines what is compiled. The run hash includes the llvmlite version.
"""
