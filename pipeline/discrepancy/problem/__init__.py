"""What is known of one measurement before any physics: its samples, drives and sizes."""
