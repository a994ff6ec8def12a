"""What is copied into a grading kernel's folder. Nothing here is trusted once a student's cell has run."""
