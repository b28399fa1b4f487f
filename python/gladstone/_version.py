"""Version of the package and of the compiled part."""

from __future__ import annotations

import json
from typing import Any

from . import _core

__version__: str = json.loads(_core.version_json())["version"]


def build() -> dict[str, Any]:
    """Returns version, commit and backends of the compiled part."""
    return json.loads(_core.version_json())
