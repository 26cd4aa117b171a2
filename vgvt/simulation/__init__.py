"""The rig in MuJoCo: the only package that imports mujoco."""
