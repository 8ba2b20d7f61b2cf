from .audit_run import AuditRun
from .history import LoopHistory
from .plant_audit import audit

__all__ = ["AuditRun", "LoopHistory", "audit"]
