"""Measurements that constants and statements of the documentation rest on."""
