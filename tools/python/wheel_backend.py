"""What `pip install .` calls (PEP 517): builds the preset python and packs the package as a wheel. It needs
nothing but Python, CMake, pybind11 and the packages of `tools/setup.sh`."""

import base64
import hashlib
import os
import re
import subprocess
import sysconfig
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PACKAGE = os.path.join(ROOT, "build", "python", "python", "leviosim")


def _version():
    with open(os.path.join(ROOT, "CMakeLists.txt")) as file:
        return re.search(r"project\(leviosim VERSION (\S+)", file.read()).group(1)


def _metadata():
    return f"Metadata-Version: 2.1\nName: leviosim\nVersion: {_version()}\nRequires-Dist: numpy\n"


def _tag():
    """Of the Python that the module was built for, which is Debian's, whichever runs this."""
    names = [re.match(r"_core\.cpython-(\d+)-.*\.so$", name) for name in os.listdir(PACKAGE)]
    version = next(name.group(1) for name in names if name)
    return "cp{0}-cp{0}-{1}".format(version, re.sub(r"[-.]", "_", sysconfig.get_platform()))


def get_requires_for_build_wheel(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Without it, pip would build everything to read three lines."""
    about = f"leviosim-{_version()}.dist-info"
    os.makedirs(os.path.join(metadata_directory, about), exist_ok=True)
    with open(os.path.join(metadata_directory, about, "METADATA"), "w") as file:
        file.write(_metadata())
    return about


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    subprocess.run([os.path.join(ROOT, "tools", "build.sh"), "python", "leviosim_python"], check=True)
    tag = _tag()
    about = f"leviosim-{_version()}.dist-info"
    files = {f"{about}/METADATA": _metadata().encode(),
             f"{about}/WHEEL": f"Wheel-Version: 1.0\nGenerator: leviosim\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()}
    for name in sorted(os.listdir(PACKAGE)):
        if name != "__pycache__":
            with open(os.path.join(PACKAGE, name), "rb") as file:
                files[f"leviosim/{name}"] = file.read()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{about}/RECORD"] = (record + f"{about}/RECORD,,\n").encode()
    wheel = f"leviosim-{_version()}-{tag}.whl"
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return wheel
