"""A PLC for the tests: exported blocks are compiled and executed, where ``make plc`` has built what that needs."""
