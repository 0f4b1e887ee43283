"""Macro/Mini controllers: control of an arm mounted on another arm."""
