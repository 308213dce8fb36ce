"""Reports: one HTML file that shows finished runs, and needs neither a server nor a network."""

from lqd_search.report.page import render_report
from lqd_search.report.report_file import check_report_path, write_report
from lqd_search.report.reported_run import ReportedRun, labels_of

__all__ = ["ReportedRun", "check_report_path", "labels_of", "render_report", "write_report"]
